// A cache of irradiance with gradients: few records, made where they are needed, interpolated in between.
// Ward et al. 1988, "A ray tracing solution for diffuse interreflection"; Ward and Heckbert 1992, "Irradiance
// gradients"; Tabellion and Lamorlette 2004, "An approximate global illumination system for computer generated films"
// (weights); Krivanek et al. 2006, "Making radiance and irradiance caching practical" (neighbour clamping).
//
// A record i serves a point p with normal n by the weight
//   w_i = 1 - max(|p - p_i| / R_i, sqrt((1 - n . n_i) / (1 - cos 25 degrees)))          if that is positive,
// unless p lies behind it; E = sum w_i (E_i + cross(n_i, n) . rotation_i + (p - p_i) . translation_i) / sum w_i.
// R_i is `reach` times the accuracy, where the reach is the harmonic mean distance of what the record sees or E over
// the length of its gradient, the less, and no more than that of any neighbour plus the distance to it: what one record
// misses, its neighbour has seen. R_i stays below max_radius. Where it would fall below min_radius, records would have
// to lie denser than it pays: the record then only says so (Answer::gather).
//
// Cost: an octree of spheres, in which a look-up is one way down; about 100 bytes per record and 80 per wavelength set.
#pragma once

#include "dapple/density/hemisphere.h"
#include "dapple/math/frame.h"

#include <array>
#include <cstdint>
#include <vector>

namespace dapple {

struct CacheRecord {
    Vec3 position;
    Frame frame;              // n: the normal on the lit side; s and t: the axes of gradients
    float reach = 0.0f;       // [m]
    float min_radius = 0.0f;  // [m]
    float max_radius = 0.0f;  // [m]
};

class IrradianceCache {
public:
    enum class Answer : uint8_t {
        none,    // no record serves the point
        gather,  // nor should one: light or surroundings change too fast there
        value,
    };

    IrradianceCache() = default;
    // bounds: of everything that is looked up. `sets` of irradiance per record; accuracy: largest R_i / reach.
    IrradianceCache(const Box3& bounds, int sets, float accuracy);

    // Adds a record with its values, one per set; clamps it by its neighbours and them by it. The cache depends on the
    // order of records, so that whoever wants it reproducible adds them in an order of his own.
    void add(const CacheRecord& record, const std::vector<HemisphereIrradiance>& values);

    // The irradiance of a set at a point of a surface [W/m^2], never negative. Thread-safe between calls of add().
    Answer look_up(const Vec3& position, const Vec3& normal, int set, Spectrum& irradiance) const;

    size_t size() const { return records_.size(); }
    // Records whose irradiance is used: those that are not marks of Answer::gather.
    size_t serving() const;
    size_t memory_bytes() const;
    // The weight of a record at a point; 0 where it does not serve.
    float weight(size_t record, const Vec3& position, const Vec3& normal) const;

private:
    struct Stored {
        CacheRecord record;
        float radius = 0.0f;
        bool gather = false;
    };
    struct Node {
        std::array<uint32_t, 8> children{};  // 0: none
        uint32_t first_entry = 0;            // 0: none
    };
    struct Entry {
        uint32_t record, next;
    };

    void settle(Stored& stored) const;
    template <class Visit>
    void visit_near(uint32_t node, const Vec3& center, float half, const Vec3& p, float radius, const Visit& visit);
    void insert_below(uint32_t node, const Vec3& center, float half, uint32_t record, const Vec3& p, float radius);

    Vec3 center_{0, 0, 0};
    float half_ = 1.0f;  // half the edge of the root
    int sets_ = 1;
    float accuracy_ = 0.2f;
    std::vector<Stored> records_;
    std::vector<HemisphereIrradiance> values_;  // of record i: sets_ from i * sets_ on
    std::vector<Node> nodes_{1};
    std::vector<Entry> entries_{1};  // the first stands for none
};

}  // namespace dapple
