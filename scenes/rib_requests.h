/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RIB_REQUESTS_H
#define RIB_REQUESTS_H

#include "scenes/rib_reader.h"

/* Where a request may stand. */
enum rib_context {
    IN_OPTIONS = 1, /* outside of world blocks */
    IN_WORLD = 2,
    IN_OBJECT = 4, /* between ObjectBegin and ObjectEnd */
    IN_SCENE = IN_OPTIONS | IN_WORLD,
    IN_GEOMETRY = IN_WORLD | IN_OBJECT,
    ANYWHERE = IN_SCENE | IN_OBJECT,
};

/* Every request that the reader knows: read_ignored ones cannot change the picture that this
 * renderer makes, read_unsupported ones can and say so.
 *
 * X(NAME, where it may stand, the function that carries it out) */
#define RIB_REQUESTS(X)                                                                            \
    X(version, ANYWHERE, read_version)                                                             \
    X(Declare, ANYWHERE, read_declare)                                                             \
    X(ReadArchive, ANYWHERE, read_archive)                                                         \
    X(FrameBegin, IN_OPTIONS, read_frame_begin)                                                    \
    X(FrameEnd, IN_OPTIONS, read_frame_end)                                                        \
    X(WorldBegin, IN_OPTIONS, read_world_begin)                                                    \
    X(WorldEnd, IN_WORLD, read_world_end)                                                          \
    X(AttributeBegin, ANYWHERE, read_attribute_begin)                                              \
    X(AttributeEnd, ANYWHERE, read_attribute_end)                                                  \
    X(TransformBegin, ANYWHERE, read_transform_begin)                                              \
    X(TransformEnd, ANYWHERE, read_transform_end)                                                  \
    X(ObjectBegin, IN_SCENE, read_object_begin)                                                    \
    X(ObjectEnd, IN_OBJECT, read_object_end)                                                       \
    X(ObjectInstance, IN_WORLD, read_object_instance)                                              \
    X(MotionBegin, ANYWHERE, read_motion_begin)                                                    \
    X(MotionEnd, ANYWHERE, read_motion_end)                                                        \
    X(Format, IN_OPTIONS, read_format)                                                             \
    X(FrameAspectRatio, IN_OPTIONS, read_frame_aspect_ratio)                                       \
    X(ScreenWindow, IN_OPTIONS, read_screen_window)                                                \
    X(CropWindow, IN_OPTIONS, read_crop_window)                                                    \
    X(Projection, IN_OPTIONS, read_projection)                                                     \
    X(Clipping, IN_OPTIONS, read_clipping)                                                         \
    X(PixelSamples, IN_OPTIONS, read_pixel_samples)                                                \
    X(Display, IN_OPTIONS, read_display)                                                           \
    X(DepthOfField, IN_OPTIONS, read_depth_of_field)                                               \
    X(Exposure, IN_OPTIONS, read_exposure)                                                         \
    X(Option, IN_OPTIONS, read_option)                                                             \
    X(Shutter, IN_OPTIONS, read_ignored)                                                           \
    X(Quantize, IN_OPTIONS, read_ignored)                                                          \
    X(Hider, IN_OPTIONS, read_ignored)                                                             \
    X(PixelFilter, IN_OPTIONS, read_ignored)                                                       \
    X(PixelVariance, IN_OPTIONS, read_ignored)                                                     \
    X(RelativeDetail, IN_OPTIONS, read_ignored)                                                    \
    X(ColorSamples, IN_OPTIONS, read_unsupported)                                                  \
    X(Imager, IN_OPTIONS, read_unsupported)                                                        \
    X(ErrorHandler, ANYWHERE, read_ignored)                                                        \
    X(Identity, ANYWHERE, read_identity)                                                           \
    X(Transform, ANYWHERE, read_transform)                                                         \
    X(ConcatTransform, ANYWHERE, read_concat_transform)                                            \
    X(Translate, ANYWHERE, read_translate)                                                         \
    X(Rotate, ANYWHERE, read_rotate)                                                               \
    X(Scale, ANYWHERE, read_scale)                                                                 \
    X(Skew, ANYWHERE, read_skew)                                                                   \
    X(Perspective, ANYWHERE, read_perspective)                                                     \
    X(CoordinateSystem, ANYWHERE, read_coordinate_system)                                          \
    X(ScopedCoordinateSystem, ANYWHERE, read_coordinate_system)                                    \
    X(CoordSysTransform, ANYWHERE, read_coord_sys_transform)                                       \
    X(Attribute, ANYWHERE, read_attribute)                                                         \
    X(Color, ANYWHERE, read_color)                                                                 \
    X(Opacity, ANYWHERE, read_opacity)                                                             \
    X(Sides, ANYWHERE, read_sides)                                                                 \
    X(Orientation, ANYWHERE, read_orientation)                                                     \
    X(ReverseOrientation, ANYWHERE, read_reverse_orientation)                                      \
    X(TextureCoordinates, ANYWHERE, read_texture_coordinates)                                      \
    X(Basis, ANYWHERE, read_basis)                                                                 \
    X(Surface, ANYWHERE, read_surface)                                                             \
    X(LightSource, IN_SCENE, read_light_source)                                                    \
    X(AreaLightSource, IN_SCENE, read_unsupported)                                                 \
    X(Illuminate, IN_SCENE, read_illuminate)                                                       \
    X(ShadingRate, ANYWHERE, read_ignored)                                                         \
    X(ShadingInterpolation, ANYWHERE, read_ignored)                                                \
    X(GeometricApproximation, ANYWHERE, read_ignored)                                              \
    X(GeometricRepresentation, ANYWHERE, read_ignored)                                             \
    X(Bound, ANYWHERE, read_ignored)                                                               \
    X(Detail, ANYWHERE, read_ignored)                                                              \
    X(DetailRange, ANYWHERE, read_unsupported)                                                     \
    X(Matte, ANYWHERE, read_unsupported)                                                           \
    X(Displacement, ANYWHERE, read_displacement)                                                   \
    X(Deformation, ANYWHERE, read_unsupported)                                                     \
    X(Atmosphere, ANYWHERE, read_atmosphere)                                                       \
    X(Interior, ANYWHERE, read_unsupported)                                                        \
    X(Exterior, ANYWHERE, read_unsupported)                                                        \
    X(TrimCurve, ANYWHERE, read_unsupported)                                                       \
    X(SolidBegin, ANYWHERE, read_unsupported)                                                      \
    X(SolidEnd, ANYWHERE, read_ignored)                                                            \
    X(Polygon, IN_GEOMETRY, read_polygon)                                                          \
    X(GeneralPolygon, IN_GEOMETRY, read_general_polygon)                                           \
    X(PointsPolygons, IN_GEOMETRY, read_points_polygons)                                           \
    X(PointsGeneralPolygons, IN_GEOMETRY, read_points_general_polygons)                            \
    X(Patch, IN_GEOMETRY, read_patch)                                                              \
    X(PatchMesh, IN_GEOMETRY, read_patch_mesh)                                                     \
    X(Sphere, IN_GEOMETRY, read_quadric)                                                           \
    X(Cylinder, IN_GEOMETRY, read_quadric)                                                         \
    X(Cone, IN_GEOMETRY, read_quadric)                                                             \
    X(Disk, IN_GEOMETRY, read_quadric)                                                             \
    X(Paraboloid, IN_GEOMETRY, read_quadric)                                                       \
    X(Hyperboloid, IN_GEOMETRY, read_quadric)                                                      \
    X(Torus, IN_GEOMETRY, read_quadric)                                                            \
    X(NuPatch, IN_GEOMETRY, read_unsupported)                                                      \
    X(SubdivisionMesh, IN_GEOMETRY, read_unsupported)                                              \
    X(HierarchicalSubdivisionMesh, IN_GEOMETRY, read_unsupported)                                  \
    X(Points, IN_GEOMETRY, read_unsupported)                                                       \
    X(Curves, IN_GEOMETRY, read_unsupported)                                                       \
    X(Blobby, IN_GEOMETRY, read_unsupported)                                                       \
    X(Procedural, IN_GEOMETRY, read_unsupported)                                                   \
    X(Geometry, IN_GEOMETRY, read_unsupported)                                                     \
    X(MakeTexture, ANYWHERE, read_unsupported)                                                     \
    X(MakeBump, ANYWHERE, read_unsupported)                                                        \
    X(MakeLatLongEnvironment, ANYWHERE, read_unsupported)                                          \
    X(MakeCubeFaceEnvironment, ANYWHERE, read_unsupported)                                         \
    X(MakeShadow, ANYWHERE, read_unsupported)

/* Each reads its own arguments; it fails through rib_error. */
#define DECLARE_REQUEST(name, context, handler) bool handler(struct rib_reader *reader);
RIB_REQUESTS(DECLARE_REQUEST)
#undef DECLARE_REQUEST

/* The end of reading a primitive (rib_requests_geometry.c): moves the list into it, checks it, and
 * keeps it in the object or tessellates it. Releases both, as rib_fail_primitive does. */
bool rib_finish_primitive(struct rib_reader *reader, struct primitive *primitive,
                          struct parameter_list *list);
/* Returns false. */
bool rib_fail_primitive(struct primitive *primitive, struct parameter_list *list);
/* The list must hold P: how many points it has. */
bool rib_find_points(struct rib_reader *reader, const struct parameter_list *list, size_t *count);

/* The named coordinate systems as they are now, for the frame; and forgets those of the world block
 * that ends. */
void rib_copy_spaces(const struct rib_reader *reader, struct scene_frame *frame);
void rib_leave_spaces(struct rib_reader *reader);

/* Blocks that are open at the end of the file is an error. */
bool rib_check_blocks_closed(struct rib_reader *reader);
/* Leaves all blocks, at the end of reading. */
void rib_blocks_finish(struct rib_reader *reader);

#endif
