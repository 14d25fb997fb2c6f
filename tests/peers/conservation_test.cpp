// Conservation: the flux of every light is absorbed, escapes, or is still on its way. Light walks keep a ledger of what
// they carry before and after each scattering and each roulette; its sum must be the emitted flux to 1e-4. Where the
// share that a surface absorbs is known in closed form (matte: 1 - reflectance, glass: nothing) the ledger is kept with
// that share of what arrives, and not with what the walk says it lost: so a weight that is wrong, a walk that ends
// without a reason or one that passes through a wall would each break the sum. What roulette takes and gives is random;
// it must be nothing in the mean.
#include "peers/peers.h"

#include "dapple/transport/emission.h"

namespace dapple::testing {
namespace {

struct Ledger {
    double emitted = 0;
    double absorbed = 0;   // at scatterings
    double roulette = 0;   // taken by it, less what it gave to survivors
    double roulette2 = 0;  // squares of the paths' shares
    double escaped = 0;
    double in_flight = 0;     // after the longest walk
    double stored = 0;        // arriving at surfaces that are no delta, as photon maps would keep it
    double lost_unknown = 0;  // ended with no reason given
};

// The share that the current vertex absorbs: NaN where it has no closed form.
double known_absorption(const Vertex& vertex)
{
    switch (vertex.bsdf.kind) {
        case BsdfKind::diffuse: return 1.0 - double(vertex.bsdf.a[1]);
        case BsdfKind::dielectric:
        case BsdfKind::thin_dielectric: return 0.0;
        default: return NAN;
    }
}

void trace(const TestScene& scene, uint32_t path, bool with_roulette, Ledger& sum)
{
    const World& world = scene.world();
    RandomStream random(11, 7, path);
    Walk walk;
    Departure departure;
    if (!emit(world, path_start(Wavelengths::rgb(), random.next_2d()), random, walk, departure)) return;
    double carried = walk.arriving()[1], roulette = 0;
    sum.emitted += carried;
    const Vertex* vertex = walk.next(world, random);
    while (vertex) {
        if (!vertex->is_delta()) sum.stored += walk.arriving()[1];
        if (walk.depth() >= 400) {
            sum.in_flight += carried;
            carried = 0;
            break;
        }
        if (with_roulette) {
            const bool survives = walk.survive_roulette(random);
            const double after = survives ? double(walk.arriving()[1]) : 0.0;
            roulette += carried - after;
            carried = after;
            if (!survives) break;
        }
        const double share = known_absorption(*vertex);
        const bool on_last = !(vertex = walk.next(world, random)) && !walk.escaped();
        const double after = on_last ? 0.0 : double(walk.arriving()[1]);
        const double absorbed = std::isnan(share) ? carried - after : share * carried;
        sum.absorbed += absorbed;
        if (on_last) sum.lost_unknown += carried - absorbed;
        carried = after;
    }
    if (walk.escaped()) sum.escaped += carried;
    sum.roulette += roulette;
    sum.roulette2 += roulette * roulette;
}

std::string closed_box() { return std::string("Material \"diffuse\" \"rgb reflectance\" [0.7 0.6 0.5]\n") + box_walls; }
std::string floor_alone()
{
    return R"(Material "diffuse" "rgb reflectance" [0.7 0.6 0.5]
Shape "bilinearmesh" "point3 P" [-1.7 -1.7 -1  1.7 -1.7 -1  -1.7 1.7 -1  1.7 1.7 -1]
)";
}
std::string balls(std::initializer_list<const char*> materials)
{
    std::string text;
    double x = -0.6;
    for (const char* material : materials) {
        text += fmt::format(
            "AttributeBegin\nMaterial {}\nTranslate {} {} -0.6\nShape \"sphere\" \"float radius\" [0.25]\n"
            "AttributeEnd\n",
            material, x, -0.5 * x);
        x += 0.6;
    }
    return text;
}

constexpr const char* sky = R"(LightSource "distant" "rgb L" [1 1 1] "point3 from" [0.3 0.2 1] "point3 to" [0 0 0]
LightSource "infinite" "rgb L" [0.5 0.5 0.5]
)";
constexpr const char* lamps = R"(LightSource "point" "rgb I" [1 1 1] "point3 from" [0.2 0.1 0.6]
LightSource "spot" "rgb I" [5 5 5] "point3 from" [-0.5 0.3 0.7] "point3 to" [0.2 0 -1]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [3 3 3] "bool twosided" [true]
Material "diffuse" "rgb reflectance" [0.4 0.4 0.4]
Translate 0.1 0.3 0.8
Rotate 20 1 0.3 0
Shape "disk" "float radius" [0.3]
AttributeEnd
AttributeBegin
AreaLightSource "diffuse" "rgb L" [3 3 3]
Material "diffuse" "rgb reflectance" [0.4 0.4 0.4]
Translate -0.7 -0.6 0.5
Shape "sphere" "float radius" [0.1]
AttributeEnd
)";

TEST(Conservation, OfTheFluxOfEveryLightInClosedAndOpenScenes)
{
    const std::string known = balls({"\"dielectric\"", "\"thindielectric\"", "\"dielectric\" \"float roughness\" [0]"});
    const std::string others =
        balls({"\"conductor\" \"float roughness\" [0.1]", "\"coateddiffuse\"", "\"coatedconductor\""});
    struct Case {
        const char* name;
        std::string surfaces;
        bool open;
    };
    const Case cases[] = {{"closed, matte and glass", closed_box() + known, false},
                          {"open, matte and glass", floor_alone() + known, true},
                          {"closed, metal and coats", closed_box() + others, false},
                          {"open, metal and coats", floor_alone() + others, true}};
    constexpr uint32_t paths = 8000;
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        const TestScene scene =
            TestScene::from_text("WorldBegin\n" + std::string(c.open ? sky : "") + lamps + c.surfaces);
        for (bool with_roulette : {false, true}) {
            Ledger sum;
            for (uint32_t i = 0; i < paths; ++i) trace(scene, i, with_roulette, sum);
            const double accounted = sum.absorbed + sum.escaped + sum.in_flight + sum.roulette;
            fmt::print(
                "[ measured ] {}{}: absorbed {:.5f}, escaped {:.5f}, in flight {:.1e}, roulette {:.5f}, sum - 1: "
                "{:.1e}; stored {:.4f}\n",
                c.name, with_roulette ? ", roulette" : "", sum.absorbed / sum.emitted, sum.escaped / sum.emitted,
                sum.in_flight / sum.emitted, sum.roulette / sum.emitted, accounted / sum.emitted - 1,
                sum.stored / sum.emitted);
            ASSERT_GT(sum.emitted, 0);
            EXPECT_NEAR(accounted, sum.emitted, 1e-4 * sum.emitted);
            EXPECT_LT(sum.in_flight, 1e-5 * sum.emitted);
            EXPECT_LT(std::abs(sum.lost_unknown), 1e-4 * sum.emitted);
            EXPECT_GT(sum.absorbed, 0.1 * sum.emitted);
            EXPECT_GT(sum.stored, sum.absorbed);
            if (c.open)
                EXPECT_GT(sum.escaped, 0.1 * sum.emitted);
            else
                EXPECT_EQ(sum.escaped, 0);
            const double deviation = std::sqrt(std::max(0.0, sum.roulette2 - sum.roulette * sum.roulette / paths));
            EXPECT_LE(std::abs(sum.roulette), 4.5 * deviation);
            EXPECT_EQ(deviation > 0, with_roulette);
        }
    }
}

}  // namespace
}  // namespace dapple::testing
