// The photon structures against nanoflann (Debian libnanoflann-dev) on the same points and queries: times of building,
// of 50-nearest and of fixed-radius queries (about 50 hits). Every round measures all of them one after the other, so
// that other load on the machine strikes all alike; CPU seconds of the whole process are used and medians printed.
// Usage: bench_photon_map [points in millions] [rounds] [queries in thousands]
#include "dapple/base/parallel.h"
#include "dapple/math/hash.h"
#include "dapple/photons/hash_grid.h"
#include "dapple/photons/photon_map.h"

#include <nanoflann.hpp>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <map>
#include <string>

using namespace dapple;

namespace {

struct Cloud {
    std::vector<Vec3> points;
    size_t kdtree_get_point_count() const { return points.size(); }
    float kdtree_get_pt(size_t i, size_t axis) const { return points[i][static_cast<int>(axis)]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const
    {
        return false;
    }
};
using Nanoflann = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, uint32_t>;

// Counts what nanoflann finds within a radius, as our visitors do.
struct CountingResults {
    float radius_squared;
    uint64_t hits = 0;
    uint64_t bits = 0;

    size_t size() const { return hits; }
    bool full() const { return true; }
    float worstDist() const { return radius_squared; }
    bool addPoint(float distance_squared, uint32_t)
    {
        if (distance_squared >= radius_squared) return true;
        ++hits;
        bits ^= float_bits(distance_squared);
        return true;
    }
};

float uniform(uint64_t i, uint64_t dimension) { return to_unit_float(hash_words(i, dimension)); }

// "surface": the walls of a unit box and two spheres in it, by area. "cube": uniform in the unit cube.
Vec3 sample_point(bool surface, uint64_t i)
{
    const float u = uniform(i, 1), v = uniform(i, 2), w = uniform(i, 3);
    if (!surface) return {u, v, w};
    constexpr float radius = 0.2f;
    constexpr float sphere_area = 4.0f * pi * radius * radius;
    float pick = w * (6.0f + 2.0f * sphere_area);
    if (pick < 6.0f) {
        const int face = static_cast<int>(pick);
        Vec3 p;
        p[face % 3] = face < 3 ? 0.0f : 1.0f;
        p[(face + 1) % 3] = u;
        p[(face + 2) % 3] = v;
        return p;
    }
    const Vec3 center = pick - 6.0f < sphere_area ? Vec3(0.3f, 0.21f, 0.4f) : Vec3(0.7f, 0.6f, 0.6f);
    const float z = 1.0f - 2.0f * u;
    const float phi = 2.0f * pi * v;
    const float s = safe_sqrt(1.0f - z * z);
    return center + Vec3(s * std::cos(phi), s * std::sin(phi), z) * radius;
}

uint32_t morton(const Vec3& p)
{
    uint32_t code = 0;
    for (int bit = 0; bit < 7; ++bit)
        for (int axis = 0; axis < 3; ++axis) {
            const auto cell = static_cast<uint32_t>(std::clamp(p[axis], 0.0f, one_minus_epsilon) * 128.0f);
            code |= (cell >> bit & 1u) << (3 * bit + axis);
        }
    return code;
}

double cpu_seconds()
{
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}
double wall_seconds()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The wall and CPU seconds of each round, per measured thing.
class Timings {
public:
    void measure(const std::string& name, const std::function<void()>& body)
    {
        const double cpu = cpu_seconds();
        const double wall = wall_seconds();
        body();
        wall_[name].push_back(wall_seconds() - wall);
        cpu_[name].push_back(cpu_seconds() - cpu);
    }
    double cpu(const std::string& name) const { return median(cpu_.at(name)); }
    double wall(const std::string& name) const { return median(wall_.at(name)); }

private:
    static double median(std::vector<double> v)
    {
        std::nth_element(v.begin(), v.begin() + static_cast<long>(v.size() / 2), v.end());
        return v[v.size() / 2];
    }
    std::map<std::string, std::vector<double>> wall_, cpu_;
};

// Runs a query for all points on `threads` threads; each returns a number that is summed, so that nothing is elided.
template <class MakeQuery>
void run_queries(const std::vector<Vec3>& queries, int threads, const MakeQuery& make_query)
{
    set_thread_count(threads);
    std::atomic<uint64_t> total = 0;
    parallel_for_ranges(static_cast<int64_t>(queries.size()), 4096, [&](int64_t begin, int64_t end) {
        auto query = make_query();
        uint64_t sum = 0;
        for (int64_t i = begin; i < end; ++i) sum += query(queries[static_cast<size_t>(i)]);
        total += sum;
    });
    if (total == 0) std::printf("no hits\n");
}

// The radius that holds 50 points on average, from the distances of 50th neighbours.
float radius_for_fifty(const PointTree& tree, const std::vector<Vec3>& queries)
{
    NearestPoints nearest(50);
    double sum = 0;
    for (size_t i = 0; i < 2000; ++i) {
        tree.find_nearest(BallRegion{queries[i]}, infinity, AcceptAll{}, nearest);
        sum += std::sqrt(nearest.distance_squared(nearest.farthest()));
    }
    return static_cast<float>(sum / 2000);
}

std::vector<Photon> photons_at(const std::vector<Vec3>& points)
{
    std::vector<Photon> photons(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
        photons[i].position = points[i];
        photons[i].flux = Spectrum(1.0f);
    }
    return photons;
}

void measure_builds(Timings& t, const Cloud& cloud, float radius)
{
    t.measure("build nanoflann 1", [&] { Nanoflann(3, cloud, {10}).buildIndex(); });
    for (int threads = 1; threads <= 2; ++threads) {
        const std::string suffix = threads == 1 ? " 1" : " 2";
        set_thread_count(threads);
        t.measure("build tree" + suffix, [&] {
            std::vector<uint32_t> order;
            PointTree built(cloud.points, order);
        });
        std::vector<std::vector<Photon>> batches;
        batches.push_back(photons_at(cloud.points));
        t.measure("build map" + suffix, [&] { PhotonMap map(std::move(batches), cloud.points.size()); });
        t.measure("build grid" + suffix, [&] { HashGrid built(cloud.points, radius); });
    }
}

void measure_queries(Timings& t, const Nanoflann& other, const PointTree& tree, const HashGrid& grid,
                     const std::vector<Vec3>& queries, const char* order, float radius)
{
    for (int threads = 1; threads <= 2; ++threads) {
        const std::string suffix = std::string(" ") + order + (threads == 1 ? " 1" : " 2");
        t.measure("k50 nanoflann" + suffix, [&] {
            run_queries(queries, threads, [&] {
                return [&, index = std::vector<uint32_t>(50), d = std::vector<float>(50)](const Vec3& q) mutable {
                    const float p[3] = {q.x, q.y, q.z};
                    return other.knnSearch(p, 50, index.data(), d.data()) + float_bits(d[49]);
                };
            });
        });
        t.measure("k50 tree" + suffix, [&] {
            run_queries(queries, threads, [&] {
                return [&, nearest = NearestPoints(50)](const Vec3& q) mutable {
                    tree.find_nearest(BallRegion{q}, infinity, AcceptAll{}, nearest);
                    return static_cast<uint64_t>(nearest.count()) + float_bits(nearest.limit());
                };
            });
        });
        t.measure("radius nanoflann" + suffix, [&] {
            run_queries(queries, threads, [&] {
                return [&](const Vec3& q) {
                    const float p[3] = {q.x, q.y, q.z};
                    CountingResults results{radius * radius};
                    other.radiusSearchCustomCallback(p, results);
                    return results.hits + results.bits;
                };
            });
        });
        const auto count_hits = [&](const auto& structure) {
            run_queries(queries, threads, [&] {
                return [&](const Vec3& q) {
                    uint64_t hits = 0;
                    uint64_t bits = 0;
                    structure(q, [&](uint32_t, float d) {
                        ++hits;
                        bits ^= float_bits(d);
                    });
                    return hits + bits;
                };
            });
        };
        t.measure("radius tree" + suffix, [&] {
            count_hits([&](const Vec3& q, const auto& visit) {
                tree.for_each_within(BallRegion{q}, radius * radius, AcceptAll{}, visit);
            });
        });
        t.measure("radius grid" + suffix,
                  [&] { count_hits([&](const Vec3& q, const auto& visit) { grid.for_each_within(q, visit); }); });
    }
}

void print_queries(const Timings& t, const char* kind, const char* ours, const char* order, int threads, double count)
{
    const std::string suffix = std::string(" ") + order + (threads == 1 ? " 1" : " 2");
    const std::string theirs = std::string(kind) + " nanoflann" + suffix;
    const std::string mine = std::string(kind) + " " + ours + suffix;
    std::printf(
        "  %-6s %-4s %-7s %d thread: nanoflann %6.3f  ours %6.3f M queries/CPU-s  ratio %5.2f  (wall ratio %5.2f)\n",
        kind, ours, order, threads, 1e-6 * count / t.cpu(theirs), 1e-6 * count / t.cpu(mine),
        t.cpu(theirs) / t.cpu(mine), t.wall(theirs) / t.wall(mine));
}

void benchmark(bool surface, size_t count, int rounds, size_t query_count)
{
    Cloud cloud;
    cloud.points.resize(count);
    std::vector<Vec3> random_queries(query_count);
    set_thread_count(0);
    parallel_for(static_cast<int64_t>(count), 4096, [&](int64_t i) {
        cloud.points[static_cast<size_t>(i)] = sample_point(surface, static_cast<uint64_t>(i));
    });
    for (size_t i = 0; i < query_count; ++i) random_queries[i] = sample_point(surface, (uint64_t{1} << 40) + i);
    std::vector<Vec3> sorted_queries = random_queries;
    std::stable_sort(sorted_queries.begin(), sorted_queries.end(),
                     [](const Vec3& a, const Vec3& b) { return morton(a) < morton(b); });

    std::vector<uint32_t> order;
    const PointTree tree(cloud.points, order);
    const float radius = radius_for_fifty(tree, random_queries);
    const HashGrid grid(cloud.points, radius);
    Nanoflann other(3, cloud, {10});
    other.buildIndex();
    Timings t;
    for (int round = 0; round < rounds; ++round) {
        measure_builds(t, cloud, radius);
        measure_queries(t, other, tree, grid, random_queries, "random", radius);
        measure_queries(t, other, tree, grid, sorted_queries, "sorted", radius);
    }
    std::printf("%s, %.0f M points, radius %g, tree %.2f and grid %.2f bytes per point\n", surface ? "surface" : "cube",
                1e-6 * static_cast<double>(count), static_cast<double>(radius),
                static_cast<double>(tree.memory_bytes()) / static_cast<double>(count),
                static_cast<double>(grid.memory_bytes()) / static_cast<double>(count));
    const double base = t.cpu("build nanoflann 1");
    std::printf("  build nanoflann %.3f s (1 thread)\n", base);
    for (const char* name : {"tree", "map", "grid"})
        for (const char* threads : {"1", "2"}) {
            const std::string key = std::string("build ") + name + " " + threads;
            std::printf("  build %-4s %s thread: CPU %.3f s, wall %.3f s, ratio by CPU %.2f, by wall %.2f\n", name,
                        threads, t.cpu(key), t.wall(key), base / t.cpu(key), t.wall("build nanoflann 1") / t.wall(key));
        }
    for (const char* query_order : {"random", "sorted"})
        for (int threads = 1; threads <= 2; ++threads) {
            print_queries(t, "k50", "tree", query_order, threads, static_cast<double>(query_count));
            print_queries(t, "radius", "tree", query_order, threads, static_cast<double>(query_count));
            print_queries(t, "radius", "grid", query_order, threads, static_cast<double>(query_count));
        }
}

}  // namespace

int main(int argc, char** argv)
{
    const double millions = argc > 1 ? std::atof(argv[1]) : 1.0;
    const int rounds = argc > 2 ? std::atoi(argv[2]) : 3;
    const double thousands = argc > 3 ? std::atof(argv[3]) : 200.0;
    for (const bool surface : {true, false})
        benchmark(surface, static_cast<size_t>(millions * 1e6), rounds, static_cast<size_t>(thousands * 1e3));
}
