// One disc laid flat with its boundary on a circle by CGAL's iterative authalic parameterization.
//
// usage: authalic MESH.obj ITERATIONS. Printed are the seconds, without reading, and the normalised L2 stretch of the result.

#include <CGAL/IO/OBJ.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/Circular_border_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/Iterative_authalic_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Vertex = boost::graph_traits<Mesh>::vertex_descriptor;
namespace Flat = CGAL::Surface_mesh_parameterization;
using Border = Flat::Circular_border_arc_length_parameterizer_3<Mesh>;
using Authalic = Flat::Iterative_authalic_parameterizer_3<Mesh, Border>;
using Places = Mesh::Property_map<Vertex, Kernel::Point_2>;

// Root of the mean squared stretch by area, 1 for an isometry up to scale; infinite if a triangle is turned over.
static double stretch(const Mesh &mesh, const Places &uv) {
    double squared = 0.0, spatial = 0.0, planar = 0.0;
    for (auto f : mesh.faces()) {
        Vertex v[3];
        int n = 0;
        for (auto w : vertices_around_face(mesh.halfedge(f), mesh)) v[n++] = w;
        const auto p = mesh.point(v[1]) - mesh.point(v[0]), q = mesh.point(v[2]) - mesh.point(v[0]);
        const auto u = uv[v[1]] - uv[v[0]], w = uv[v[2]] - uv[v[0]];
        const double area = 0.5 * std::sqrt(CGAL::cross_product(p, q).squared_length());
        const double flat = 0.5 * (u.x() * w.y() - u.y() * w.x());
        if (!(flat > 0.0)) return std::numeric_limits<double>::infinity();
        const auto by_x = (p * w.y() - q * u.y()) / (2.0 * flat), by_y = (q * u.x() - p * w.x()) / (2.0 * flat);
        squared += 0.5 * (by_x.squared_length() + by_y.squared_length()) * area;
        spatial += area;
        planar += flat;
    }
    return std::sqrt(squared / spatial * planar / spatial);
}

int main(int argc, char **argv) {
    if (argc != 3) return 2;
    Mesh mesh;
    std::ifstream file(argv[1]);
    if (!CGAL::IO::read_OBJ(file, mesh)) return 2;
    Places uv = mesh.add_property_map<Vertex, Kernel::Point_2>("v:uv").first;
    const auto start = std::chrono::steady_clock::now();
    const auto border = CGAL::Polygon_mesh_processing::longest_border(mesh).first;
    Authalic authalic;
    const auto done = authalic.parameterize(mesh, border, uv, static_cast<unsigned int>(std::atoi(argv[2])));
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (done != Flat::OK) return 1;
    std::printf("%.3f %.6f\n", seconds, stretch(mesh, uv));
}
