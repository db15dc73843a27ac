// Lays a disc flat with its boundary on a circle, mean value weights divided by stretch again and again (Yoshizawa, Belyaev,
// Seidel: A fast and simple stretch-minimizing mesh parameterization, 2004), with Eigen's sparse LU factorisation.
//
// yoshizawa MESH.obj: goes on until the normalised L2 stretch gets no better; prints the seconds without those of reading, the
// stretch, and how often the system was solved.

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <vector>

using Point = Eigen::Vector3d;
using Place = Eigen::Vector2d;
using Face = Eigen::Vector3i;

// A round that lowers the stretch by a smaller share is the last.
const double SETTLED = 1e-3;
const int ROUNDS = 20;

struct Disc {
    std::vector<Point> points;
    std::vector<Face> faces;
};

static Disc read(const char *path) {
    Disc disc;
    std::FILE *file = std::fopen(path, "r");
    char line[512];
    while (file && std::fgets(line, sizeof line, file)) {
        double x, y, z;
        int a, b, c;
        if (std::sscanf(line, "v %lf %lf %lf", &x, &y, &z) == 3) {
            disc.points.emplace_back(x, y, z);
        } else if (std::sscanf(line, "f %d %d %d", &a, &b, &c) == 3) {
            disc.faces.emplace_back(a - 1, b - 1, c - 1);
        }
    }
    return disc;
}

static double planar_area(const std::vector<Place> &at, const Face &f) {
    const Place u = at[f[1]] - at[f[0]], w = at[f[2]] - at[f[0]];
    return 0.5 * (u.x() * w.y() - u.y() * w.x());
}

static double spatial_area(const Disc &disc, const Face &f) {
    return 0.5 * (disc.points[f[1]] - disc.points[f[0]]).cross(disc.points[f[2]] - disc.points[f[0]]).norm();
}

// The squared L2 stretch of the map from the plane to the surface on one triangle.
static double squared_stretch(const Disc &disc, const std::vector<Place> &at, const Face &f) {
    const double per_area = 0.5 / planar_area(at, f);
    Point by_x = Point::Zero(), by_y = Point::Zero();
    for (int k = 0; k < 3; ++k) {
        const Place across = at[f[(k + 2) % 3]] - at[f[(k + 1) % 3]];
        by_x -= disc.points[f[k]] * across.y() * per_area;
        by_y += disc.points[f[k]] * across.x() * per_area;
    }
    return 0.5 * (by_x.squaredNorm() + by_y.squaredNorm());
}

int main(int count, char **arguments) {
    if (count != 2) return 2;
    const Disc disc = read(arguments[1]);
    const std::clock_t start = std::clock();
    const int n = disc.points.size();

    // Mean value weights of the half-edges; those that have no other half run along the boundary.
    std::map<std::pair<int, int>, double> weights;
    std::map<int, int> next;
    for (const Face &f : disc.faces) {
        for (int k = 0; k < 3; ++k) {
            const int v = f[k], a = f[(k + 1) % 3], b = f[(k + 2) % 3];
            const Point to_a = disc.points[a] - disc.points[v], to_b = disc.points[b] - disc.points[v];
            const double angle = std::atan2(to_a.cross(to_b).norm(), to_a.dot(to_b));
            weights[{v, a}] += std::tan(0.5 * angle) / to_a.norm();
            weights[{v, b}] += std::tan(0.5 * angle) / to_b.norm();
        }
    }
    std::map<std::pair<int, int>, bool> halves;
    for (const Face &f : disc.faces) {
        for (int k = 0; k < 3; ++k) halves[{f[k], f[(k + 1) % 3]}] = true;
    }
    for (const auto &[half, _] : halves) {
        if (!halves.count({half.second, half.first})) next[half.first] = half.second;
    }

    std::vector<Place> at(n, Place::Zero());
    std::vector<int> number(n, -1);
    int v = next.begin()->first;
    for (size_t i = 0; i < next.size(); ++i, v = next[v]) {
        const double turn = 2 * M_PI * i / next.size();
        at[v] = Place(std::cos(turn), std::sin(turn));
    }
    int unknowns = 0;
    for (int i = 0; i < n; ++i) {
        if (!next.count(i)) number[i] = unknowns++;
    }

    Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> solver;
    std::vector<double> sigma(n, 1.0);
    double last = INFINITY;
    int solved = 0;
    while (solved < ROUNDS) {
        // A weight goes by the stretch at its far end.
        std::vector<Eigen::Triplet<double>> entries;
        std::vector<double> sums(n, 0.0);
        for (auto &[half, weight] : weights) {
            weight /= sigma[half.second];
            sums[half.first] += weight;
        }
        Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(unknowns, 2);
        for (const auto &[half, weight] : weights) {
            const int row = number[half.first], column = number[half.second];
            if (row < 0) continue;
            const double share = weight / sums[half.first];
            if (column < 0) right.row(row) += share * at[half.second].transpose();
            else entries.emplace_back(row, column, -share);
        }
        for (int i = 0; i < unknowns; ++i) entries.emplace_back(i, i, 1.0);
        Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
        matrix.setFromTriplets(entries.begin(), entries.end());
        if (solved == 0) solver.analyzePattern(matrix);
        solver.factorize(matrix);
        const Eigen::MatrixX2d found = solver.solve(right);
        ++solved;
        for (int i = 0; i < n; ++i) {
            if (number[i] >= 0) at[i] = found.row(number[i]).transpose();
        }

        double sum = 0, spatial = 0, planar = 0;
        std::vector<double> around(n, 0.0), area(n, 0.0);
        for (const Face &f : disc.faces) {
            const double surface = spatial_area(disc, f), squared = squared_stretch(disc, at, f);
            sum += surface * squared;
            spatial += surface;
            planar += planar_area(at, f);
            for (int k = 0; k < 3; ++k) {
                around[f[k]] += surface * squared;
                area[f[k]] += surface;
            }
        }
        const double stretch = std::sqrt(sum / spatial * planar / spatial);
        if (!(stretch < last * (1 - SETTLED))) {
            last = std::fmin(last, stretch);
            break;
        }
        last = stretch;
        for (int i = 0; i < n; ++i) sigma[i] = std::sqrt(around[i] / area[i]);
    }
    std::printf("%.3f %.4f %d\n", double(std::clock() - start) / CLOCKS_PER_SEC, last, solved);
}
