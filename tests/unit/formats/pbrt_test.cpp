// What the pbrt reader makes of correct scenes: transforms, state, inheritance, entities and warnings.
#include "dapple/formats/pbrt.h"

#include "dapple/base/temp_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace dapple {
namespace {

scene::Description read(const std::string& text) { return read_pbrt_string(text, "a.pbrt", "/scenes"); }
scene::Description world(const std::string& text) { return read("WorldBegin\n" + text); }

Vec3 apply(const Matrix4& matrix, const Vec3& p) { return Transform(matrix).point(p); }
void expect_near(const Vec3& a, const Vec3& b) { EXPECT_LT(length(a - b), 1e-5f) << a << " " << b; }
bool warns(const scene::Description& scene, const std::string& text)
{
    return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                       [&](const std::string& warning) { return warning.find(text) != warning.npos; });
}

TEST(PbrtTransforms, ComposeFromTheRight)
{
    const auto scene = world("Translate 1 2 3 Rotate 90 0 0 1 Scale 2 3 4 Shape \"sphere\"");
    // Scaled, then turned from x to y, then moved.
    expect_near(apply(scene.shapes[0].world_from_object.start, {1, 0, 0}), {1, 4, 3});
    expect_near(apply(scene.shapes[0].world_from_object.start, {0, 1, 0}), {-2, 2, 3});
}

TEST(PbrtTransforms, MatricesAreColumnByColumn)
{
    const auto scene = world(
        "Scale 9 9 9 Transform [ 1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1 ] "
        "ConcatTransform [ 2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1 ] Shape \"sphere\" Identity Shape \"disk\"");
    expect_near(apply(scene.shapes[0].world_from_object.start, {1, 1, 1}), {7, 8, 9});
    EXPECT_EQ(scene.shapes[1].world_from_object.start, Matrix4());
}

TEST(PbrtTransforms, CameraIsTheInverseAndLooksAlongZ)
{
    const auto scene = read(
        "LookAt 1 2 3  1 2 13  0 1 0 Camera \"perspective\" \"float fov\" 40 "
        "WorldBegin CoordSysTransform \"camera\" Shape \"sphere\"");
    const Matrix4& camera = scene.camera.world_from_camera.start;
    expect_near(apply(camera, {0, 0, 0}), {1, 2, 3});
    expect_near(apply(camera, {0, 0, 1}), {1, 2, 4});
    expect_near(apply(camera, {1, 0, 0}), {2, 2, 3});  // left-handed: looking along +z with y up, x is to the right
    expect_near(apply(camera, {0, 1, 0}), {1, 3, 3});
    EXPECT_EQ(scene.shapes[0].world_from_object.start, camera);
    EXPECT_EQ(scene.camera.fov, 40.0f);
    // The usual Scale -1 1 1 before LookAt mirrors the picture.
    const auto mirrored = read("Scale -1 1 1 LookAt 0 0 0 0 0 1 0 1 0 Camera \"perspective\" WorldBegin");
    expect_near(apply(mirrored.camera.world_from_camera.start, {1, 0, 0}), {-1, 0, 0});
}

TEST(PbrtTransforms, MoveBetweenTheirTimes)
{
    const auto scene = read(
        "TransformTimes 0.5 2 WorldBegin ActiveTransform EndTime Translate 0 0 1 "
        "ActiveTransform StartTime Translate 1 0 0 ActiveTransform All Translate 0 1 0 Shape \"sphere\"");
    const scene::MovingMatrix& matrix = scene.shapes[0].world_from_object;
    EXPECT_TRUE(matrix.moves());
    expect_near(apply(matrix.start, {0, 0, 0}), {1, 1, 0});
    expect_near(apply(matrix.end, {0, 0, 0}), {0, 1, 1});
    EXPECT_EQ(matrix.start_time, 0.5f);
    EXPECT_EQ(matrix.end_time, 2.0f);
}

TEST(PbrtTransforms, NamedSystemsAndWorld)
{
    const auto scene = world(
        "Translate 1 0 0 CoordinateSystem \"here\" Scale 5 5 5 CoordSysTransform \"here\" "
        "Shape \"sphere\" CoordSysTransform \"world\" Shape \"sphere\"");
    expect_near(apply(scene.shapes[0].world_from_object.start, {1, 0, 0}), {2, 0, 0});
    EXPECT_EQ(scene.shapes[1].world_from_object.start, Matrix4());
}

TEST(PbrtState, AttributeBlocksSaveAll)
{
    const auto scene = world(
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\n"
        "AttributeBegin Translate 1 0 0 ReverseOrientation Material \"dielectric\" MediumInterface \"fog\" \"\" "
        "AreaLightSource \"diffuse\" Attribute \"shape\" \"float radius\" 3 Shape \"sphere\" AttributeEnd Shape "
        "\"sphere\"");
    const scene::Shape &inner = scene.shapes[0], &outer = scene.shapes[1];
    EXPECT_TRUE(inner.reverse_orientation);
    EXPECT_EQ(inner.material.value, 1u);
    EXPECT_EQ(inner.inside.value, 0u);
    EXPECT_FALSE(inner.outside.valid());
    EXPECT_TRUE(inner.medium_interface);
    EXPECT_EQ(inner.area_light.value, 0u);
    EXPECT_EQ(std::get<scene::Sphere>(inner.geometry).radius, 3.0f);
    EXPECT_EQ(std::get<scene::Sphere>(inner.geometry).z_max, 3.0f);
    EXPECT_FALSE(outer.reverse_orientation);
    EXPECT_EQ(outer.material.value, 0u);
    EXPECT_FALSE(outer.medium_interface || outer.area_light.valid() || outer.inside.valid());
    EXPECT_EQ(std::get<scene::Sphere>(outer.geometry).radius, 1.0f);
}

TEST(PbrtState, DefaultsRankBelowOwnParametersAndNeedNotFit)
{
    const auto scene = world(
        "Attribute \"shape\" \"float radius\" 3 \"float nothing\" 1 "
        "Attribute \"shape\" \"float radius\" 4 Shape \"sphere\" \"float radius\" 5 Shape \"disk\" "
        "Attribute \"light\" \"string lightgroup\" \"key\" LightSource \"point\"");
    EXPECT_EQ(std::get<scene::Sphere>(scene.shapes[0].geometry).radius, 5.0f);
    EXPECT_EQ(std::get<scene::Disk>(scene.shapes[1].geometry).radius, 4.0f);
    EXPECT_EQ(scene.lights[0].light_group, "key");
}

TEST(PbrtState, ObjectsKeepTheirShapes)
{
    const auto scene = world(
        "Translate 1 0 0 ObjectBegin \"o\" Translate 0 1 0 Shape \"sphere\" Shape \"disk\" ObjectEnd "
        "Shape \"cylinder\" Scale 2 2 2 ObjectInstance \"o\" ObjectInstance \"o\"");
    ASSERT_EQ(scene.objects.size(), 1u);
    ASSERT_EQ(scene.objects[0].shapes.size(), 2u);
    expect_near(apply(scene.objects[0].shapes[0].world_from_object.start, {0, 0, 0}), {1, 1, 0});
    EXPECT_EQ(scene.shapes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 2u);
    expect_near(apply(scene.instances[1].world_from_object.start, {1, 0, 0}), {3, 0, 0});
}

TEST(PbrtReferences, MayComeBeforeWhatTheyName)
{
    const auto scene = world(
        "MediumInterface \"fog\" \"\" NamedMaterial \"late\" Shape \"sphere\" \"texture alpha\" \"holes\"\n"
        "MakeNamedMaterial \"late\" \"string type\" \"mix\" \"string materials\" [ \"a\" \"b\" ]\n"
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"texture reflectance\" \"wood\"\n"
        "MakeNamedMaterial \"b\" \"string type\" \"conductor\"\n"
        "Texture \"wood\" \"spectrum\" \"imagemap\" \"string filename\" \"wood.png\"\n"
        "Texture \"holes\" \"float\" \"constant\" \"float value\" 0.5\n"
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"string preset\" \"Skin1\" \"float g\" 0.7\n");
    EXPECT_EQ(scene.shapes[0].alpha.texture.value, 0u);
    EXPECT_EQ(scene.media[scene.shapes[0].inside.value].name, "fog");
    const auto& mix = std::get<scene::MixMaterial>(scene.materials[scene.shapes[0].material.value].kind);
    EXPECT_EQ(scene.materials[mix.materials[0].value].name, "a");
    EXPECT_TRUE(std::holds_alternative<scene::ConductorMaterial>(scene.materials[mix.materials[1].value].kind));
    const auto& wood = std::get<scene::ImageTexture>(scene.spectrum_textures[0].kind);
    EXPECT_EQ(wood.file, std::filesystem::path("/scenes/wood.png"));
}

TEST(PbrtEntities, SpectraOfAllKinds)
{
    const auto scene = world(
        "LightSource \"point\" ColorSpace \"rec2020\" LightSource \"point\" \"rgb I\" [ 1 2 3 ] "
        "LightSource \"point\" \"blackbody I\" 4000 LightSource \"point\" \"spectrum I\" \"stdillum-D65\" "
        "LightSource \"point\" \"spectrum I\" [ 400 1 700 2 ] \"float power\" 100 \"float scale\" 2");
    const auto& at = [&](size_t i) { return std::get<scene::PointLight>(scene.lights[i].kind).intensity; };
    EXPECT_EQ(std::get<scene::White>(at(0).value).color_space, scene::ColorSpace::srgb);
    EXPECT_EQ(std::get<scene::Rgb>(at(1).value), (scene::Rgb{{1, 2, 3}, scene::ColorSpace::rec2020}));
    EXPECT_EQ(std::get<scene::Blackbody>(at(2).value).kelvin, 4000.0f);
    EXPECT_EQ(std::get<scene::Named>(at(3).value).name, "stdillum-D65");
    EXPECT_EQ(std::get<scene::Samples>(at(4).value).lambda, (std::vector<float>{400, 700}));
    EXPECT_EQ(at(4).at.line, 2);
    EXPECT_EQ(scene.lights[4].power, 100.0f);
    EXPECT_EQ(scene.lights[0].power, std::nullopt);
}

TEST(PbrtEntities, MaterialsKeepPbrtsDefaults)
{
    const auto scene = world(
        "Material \"dielectric\" \"spectrum eta\" \"glass-BK7\" \"float roughness\" 0.2 \"float vroughness\" 0.1\n"
        "Material \"coatedconductor\" \"float interface.roughness\" 0.3 \"rgb reflectance\" [ .1 .2 .3 ]\n"
        "Material \"coateddiffuse\" \"bool remaproughness\" false \"float eta\" 1.3\nMaterial \"hair\"\nMaterial "
        "\"none\"\n");
    const auto& glass = std::get<scene::DielectricMaterial>(scene.materials[1].kind);
    EXPECT_EQ(glass.roughness.u.value, 0.2f);
    EXPECT_EQ(glass.roughness.v.value, 0.1f);
    EXPECT_EQ(std::get<scene::Named>(glass.eta.value).name, "glass-BK7");
    const auto& metal = std::get<scene::CoatedConductorMaterial>(scene.materials[2].kind);
    EXPECT_EQ(metal.coat.roughness.u.value, 0.3f);
    EXPECT_EQ(metal.roughness.u.value, 0.0f);
    EXPECT_TRUE(metal.reflectance.has_value());
    EXPECT_EQ(metal.coat.max_depth, 10);
    const auto& paint = std::get<scene::CoatedDiffuseMaterial>(scene.materials[3].kind);
    EXPECT_FALSE(paint.remap_roughness);
    EXPECT_EQ(std::get<scene::Constant>(paint.coat.eta.value).value, 1.3f);
    EXPECT_TRUE(std::holds_alternative<scene::DiffuseMaterial>(scene.materials[4].kind));
    EXPECT_TRUE(std::holds_alternative<scene::InterfaceMaterial>(scene.materials[5].kind));
    EXPECT_TRUE(warns(scene, "a.pbrt:5:1: material 'hair' is not supported: a diffuse material"));
}

TEST(PbrtEntities, MeshesAndPatches)
{
    const auto scene = world(
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"point2 uv\" [ 0 0 1 0 0 1 ] \"normal N\" [ 0 0 1 "
        "0 0 1 0 0 1 ] \"vector3 S\" [ 1 2 3 4 5 6 7 8 9 ]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 1 1 0 ]\n"
        "Shape \"loopsubdiv\" \"integer levels\" 2 \"point P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 2 1 0 ]\n");
    const auto& triangle = *std::get<scene::Mesh>(scene.shapes[0].geometry).data;
    EXPECT_EQ(triangle.triangles, (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_EQ(triangle.normals.size(), 3u);
    EXPECT_EQ(triangle.uvs[2], Vec2(0, 1));
    EXPECT_EQ(triangle.tangents, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
    EXPECT_EQ(std::get<scene::Mesh>(scene.shapes[1].geometry).data->quads, (std::vector<uint32_t>{0, 1, 2, 3}));
    const auto& loop = std::get<scene::LoopSubdivision>(scene.shapes[2].geometry);
    EXPECT_EQ(loop.levels, 2);
    EXPECT_EQ(loop.data->triangles, (std::vector<uint32_t>{2, 1, 0}));
}

TEST(PbrtEntities, FilmCropAndSensor)
{
    const auto cropped = read(
        "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 50 "
        "\"float cropwindow\" [ .25 .5 0 1 ] \"string sensor\" \"nikon_d850\" \"float iso\" 200 "
        "Camera \"perspective\" \"float shutterclose\" 0.5 WorldBegin");
    EXPECT_EQ(cropped.film.crop_min, Int2(25, 0));
    EXPECT_EQ(cropped.film.crop_max, Int2(50, 50));
    EXPECT_EQ(cropped.film.sensor, "nikon_d850");
    EXPECT_EQ(cropped.film.imaging_ratio(cropped.camera), 1.0f);
    const auto bounded = read("Film \"gbuffer\" \"integer pixelbounds\" [ 10 2000 5 6 ] WorldBegin");
    EXPECT_EQ(bounded.film.crop_min, Int2(10, 5));
    EXPECT_EQ(bounded.film.crop_max, Int2(1280, 6));
    EXPECT_TRUE(warns(bounded, "reaches beyond the image"));
}

TEST(PbrtEntities, IntegratorParametersArePassedOn)
{
    const auto scene = read(
        "Integrator \"sppm\" \"integer maxdepth\" 9 \"float radius\" 0.01 \"bool regularize\" true "
        "Sampler \"stratified\" \"integer xsamples\" 3 \"integer ysamples\" 5 WorldBegin");
    ASSERT_EQ(scene.integrator.parameters.size(), 3u);
    EXPECT_EQ(scene.integrator.name, "sppm");
    EXPECT_EQ(scene.integrator.parameters[0].value, "9");
    EXPECT_EQ(scene.integrator.parameters[1].value, "0.01");
    EXPECT_EQ(scene.integrator.parameters[2].value, "true");
    EXPECT_EQ(scene.sampler.pixel_samples, 15);
}

TEST(PbrtEntities, MediaOfAllKinds)
{
    const auto scene = world(
        "Translate 0 0 1\n"
        "MakeNamedMedium \"g\" \"string type\" \"uniformgrid\" \"float density\" [ 0 1 2 3 ] \"integer nx\" 2 "
        "\"integer nz\" 2\n"
        "MakeNamedMedium \"c\" \"string type\" \"rgbgrid\" \"rgb sigma_s\" [ 1 2 3 ] \"point3 p1\" [ 2 2 2 ]\n"
        "MakeNamedMedium \"v\" \"string type\" \"nanovdb\" \"string filename\" \"smoke.nvdb\" \"float scale\" 4\n"
        "MakeNamedMedium \"k\" \"string type\" \"cloud\" \"float density\" 6\n");
    const auto& grid = std::get<scene::UniformGridMedium>(scene.media[0].kind);
    EXPECT_EQ(grid.density.nx * grid.density.ny * grid.density.nz, 4);
    expect_near(apply(scene.media[0].world_from_medium, {0, 0, 0}), {0, 0, 1});
    EXPECT_EQ(std::get<scene::RgbGridMedium>(scene.media[1].kind).sigma_s.values[0], Vec3(1, 2, 3));
    EXPECT_EQ(std::get<scene::NanoVdbMedium>(scene.media[2].kind).file, std::filesystem::path("/scenes/smoke.nvdb"));
    EXPECT_EQ(scene.media[2].scale, 4.0f);
    EXPECT_EQ(scene.media[3].scale, 6.0f);
    EXPECT_TRUE(warns(scene, "medium 'cloud' is not supported"));
}

TEST(PbrtWarnings, RepeatsAreCounted)
{
    const auto scene = world("Shape \"curve\" \"float width\" 1\nShape \"curve\"\nShape \"curve\"\nWorldEnd");
    EXPECT_TRUE(scene.shapes.empty());
    ASSERT_EQ(scene.warnings.size(), 2u);
    EXPECT_EQ(scene.warnings[0], "a.pbrt:2:1: shape 'curve' is not supported: it is left out (and 2 more)");
}

class PbrtFiles : public testing::Test {
protected:
    void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
    TempFolder folder_;
};

TEST_F(PbrtFiles, IncludeSharesTheStateAndImportDoesNot)
{
    write("part.pbrt", "Translate 1 0 0 Shape \"sphere\"");
    write("main.pbrt", "WorldBegin Include \"part.pbrt\" Import \"part.pbrt\" Shape \"sphere\"");
    const auto scene = read_pbrt(folder_ / "main.pbrt");
    ASSERT_EQ(scene.shapes.size(), 3u);
    expect_near(apply(scene.shapes[0].world_from_object.start, {0, 0, 0}), {1, 0, 0});
    expect_near(apply(scene.shapes[1].world_from_object.start, {0, 0, 0}), {2, 0, 0});
    expect_near(apply(scene.shapes[2].world_from_object.start, {0, 0, 0}), {1, 0, 0});
    EXPECT_EQ(scene.shapes[0].at.file, (folder_ / "part.pbrt").string());
}

TEST_F(PbrtFiles, LimitsHold)
{
    for (int i = 0; i < 10; ++i)
        write("d" + std::to_string(i) + ".pbrt", "Include \"d" + std::to_string(i + 1) + ".pbrt\"");
    write("d10.pbrt", "WorldBegin");
    EXPECT_NO_THROW(read_pbrt(folder_ / "d0.pbrt"));
    EXPECT_THROW(read_pbrt(folder_ / "d0.pbrt", {.include_depth = 5}), UserError);
    EXPECT_THROW(read_pbrt(folder_ / "d0.pbrt", {.include_count = 5}), UserError);
    EXPECT_THROW(read_pbrt(folder_ / "d0.pbrt", {.other_files = false}), UserError);
}

TEST_F(PbrtFiles, TheSameMeshIsReadOnce)
{
    write("t.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 3 0 1 2\n");
    write("main.pbrt",
          "WorldBegin Shape \"plymesh\" \"string filename\" \"t.ply\" Shape \"plymesh\" \"string filename\" \"t.ply\"");
    const auto scene = read_pbrt(folder_ / "main.pbrt");
    EXPECT_EQ(std::get<scene::Mesh>(scene.shapes[0].geometry).data,
              std::get<scene::Mesh>(scene.shapes[1].geometry).data);
}

TEST_F(PbrtFiles, AllOfThemAreListedOnce)
{
    write("part.pbrt", "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.png\"");
    write("gold.spd", "400 0.5\n700 0.9\n");
    write("main.pbrt",
          "Film \"rgb\" \"string filename\" \"out.exr\" WorldBegin Include \"part.pbrt\" "
          "LightSource \"infinite\" \"string filename\" \"sky.exr\" "
          "Material \"diffuse\" \"spectrum reflectance\" \"gold.spd\" "
          "Material \"diffuse\" \"spectrum reflectance\" \"gold.spd\" Shape \"sphere\"");
    std::vector<std::string> names;
    for (const std::filesystem::path& file : read_pbrt(folder_ / "main.pbrt").files)
        names.push_back(file.lexically_relative(folder_.path()).string());
    EXPECT_EQ(names.front(), "main.pbrt");
    std::sort(names.begin(), names.end());
    EXPECT_EQ(names, (std::vector<std::string>{"gold.spd", "main.pbrt", "part.pbrt", "sky.exr", "t.png"}));
}

// Scenes of other people's making; a file without WorldBegin is a part of another.
TEST(PbrtScenes, TheSharedOnesRead)
{
    const std::filesystem::path shared = "/work/shared/scenes";
    if (!std::filesystem::exists(shared)) GTEST_SKIP() << "the shared scenes are not here";
    int scenes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(shared)) {
        if (entry.path().extension() != ".pbrt") continue;
        if (read_file(entry.path(), {}).find("WorldBegin") == std::string::npos) continue;
        ++scenes;
        EXPECT_NO_THROW({
            const auto scene = read_pbrt(entry.path());
            EXPECT_FALSE(scene.shapes.empty() && scene.instances.empty()) << entry.path();
        }) << entry.path();
    }
    EXPECT_GT(scenes, 10);
}

}  // namespace
}  // namespace dapple
