"""What Blender sees of an EXR file and an OBJ file, written to a file of arrays: IMAGE MESH OUT."""

import sys

import bpy
import numpy

image_path, mesh_path, out = sys.argv[1:]
image = bpy.data.images.load(image_path)
image.colorspace_settings.name = "Non-Color"
width, height = image.size
pixels = numpy.empty(width * height * image.channels, numpy.float32)
image.pixels.foreach_get(pixels)
bpy.ops.wm.obj_import(filepath=mesh_path)
mesh = bpy.context.selected_objects[0].data
numpy.savez(
    out,
    version=bpy.app.version_string,
    pixels=pixels.reshape(height, width, image.channels),
    counts=[len(mesh.vertices), len(mesh.polygons)],
)
