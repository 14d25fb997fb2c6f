// Differential geometry of triangles as meshes store them. The world calls this at every hit, so it takes plain values
// and touches no tables.
#pragma once

#include "dapple/shapes/surface_point.h"

namespace dapple {

struct MeshTriangle {
    Vec3 p[3];
    Vec3 n[3];   // shading normals, in the space of p, negated already under ReverseOrientation; used when has_normals
    Vec2 uv[3];  // used when has_uv, else (0,0), (1,0), (1,1) as in pbrt
    Vec3 s[3];   // shading tangents, in the space of p; used when has_tangents
    bool has_normals = false;
    bool has_uv = false;
    bool has_tangents = false;
    bool flip = false;  // ReverseOrientation xor "the transform swaps handedness", see Primitive::flip
};

// The point with barycentric coordinates (b1, b2) of vertices 1 and 2, as Embree reports them.
// n_geometric is cross(p1 - p0, p2 - p0) normalised, negated by flip; with shading normals it is turned to the side of
// the interpolated one. dpdu and dpdv follow the uv; where these are degenerate they are an orthonormal tangent frame.
// dpdu_shading follows the shading tangents, interpolated, else dpdu.
// A triangle without area has some unit normal. Without tangents (SurfaceDetail) dpdu to dndv keep their defaults.
SurfacePoint mesh_surface_point(const MeshTriangle& triangle, const Vec2& barycentrics, float time,
                                SurfaceDetail detail = SurfaceDetail::tangents);

// The same for a triangle whose corners lie elsewhere: what a hit costs most without. Writes into `point`; what is not
// wanted keeps what it held.
struct TriangleCorners {
    const Vec3* p[3];
    const Vec3* n[3];   // used when has_normals
    const Vec2* uv[3];  // used when has_uv
    const Vec3* s[3];   // used when has_tangents
    bool has_normals = false;
    bool has_uv = false;
    bool has_tangents = false;
    bool flip = false;
};
void triangle_surface_point(const TriangleCorners& triangle, const Vec2& barycentrics, float time, SurfaceDetail detail,
                            SurfacePoint& point);

// The barest and commonest of them: no shading normals, no uv wanted. positions: followed by 4 bytes or more that may
// be read; corners: the indices of three of them.
void bare_surface_point(const Vec3* positions, const uint32_t* corners, bool flip, const Vec2& barycentrics, float time,
                        SurfacePoint& point);

// Absolute bound per axis of the height at which single-precision ray-triangle tests (Moeller and Trumbore 1997, as in
// Embree) may still report a hit with this triangle for rays that leave one of its points: see mesh.cpp.
Vec3 mesh_error_bound(const Vec3& p0, const Vec3& p1, const Vec3& p2);

}  // namespace dapple
