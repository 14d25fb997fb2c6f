// Scenes of a few shapes, made in code, for the tests of transport.
#pragma once

#include "dapple/world/compile.h"

#include <gtest/gtest.h>

namespace dapple::test {

class SmallScene {
public:
    SmallScene() { description.materials.emplace_back(); }

    template <class Kind>
    scene::MaterialIndex material(const Kind& kind)
    {
        description.materials.emplace_back().kind = kind;
        return scene::MaterialIndex(description.materials.size() - 1);
    }
    scene::MediumIndex absorber(const scene::SpectrumSource& sigma_a)
    {
        scene::HomogeneousMedium& medium = description.media.emplace_back().kind.emplace<scene::HomogeneousMedium>();
        medium.sigma_a = sigma_a;
        medium.sigma_s = scene::SpectrumSource(scene::Constant{0.0f});
        return scene::MediumIndex(description.media.size() - 1);
    }
    scene::Light& light(decltype(scene::Light::kind) kind)
    {
        description.lights.emplace_back().kind = std::move(kind);
        return description.lights.back();
    }
    // Gives the shape made last an area light of radiance 1 (luminance).
    scene::AreaLight& emit()
    {
        description.shapes.back().area_light = scene::AreaLightIndex(description.area_lights.size());
        return description.area_lights.emplace_back();
    }
    // A square of the given half width at height z, outside upwards.
    scene::Shape& square(float z, float half, scene::MaterialIndex material)
    {
        scene::MeshData data;
        data.positions = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
        data.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        data.triangles = {0, 1, 2, 0, 2, 3};
        return shape(scene::Mesh{std::make_shared<scene::MeshData>(std::move(data))}, material);
    }
    scene::Shape& shape(decltype(scene::Shape::geometry) geometry, scene::MaterialIndex material)
    {
        scene::Shape& shape = description.shapes.emplace_back();
        shape.geometry = std::move(geometry);
        shape.material = material;
        return shape;
    }
    std::unique_ptr<World> world() const { return compile(description); }

    scene::Description description;
};

}  // namespace dapple::test
