// How a gather ray shares light with the photons of the surfaces that it has left (transport/caustic_share.h).
//
// Light that comes to a vertex v of the ray straight from its source, or by narrow lobes alone, is a caustic at an
// earlier vertex x too, with the product of s over the scatterings in between, that at v included. What is left of it
// is counted at v. The sum over all ways to count a path is one (CausticRun in test_integrators).
//   at x      photons of the caustic map. One that is seen in a narrow lobe of x counts 1 - s, and the ray that
//             leaves by it brings the other s; but of light that comes through deltas alone the photon has all.
//   mapped    where the global map stands for a vertex with a coat, the ray goes on with probability s, to find what
//             the coat mirrors. Light that comes there straight or through deltas alone it might not find: the map
//             keeps what is left of that.
#pragma once

#include "dapple/base/path_class.h"
#include "dapple/transport/caustic_share.h"

namespace dapple {

class CausticRun {
public:
    // left: the ray has just left a matte surface that is none of its vertices.
    explicit CausticRun(bool left = false) : so_far_(left ? 1.0f : 0.0f) {}

    // A vertex was left. pdf: density of the ray's new direction, 0 of a delta lobe; share: s of light that comes that
    // way; wide: is_wide; mapped: see above.
    void leave(float pdf, float share, bool wide, bool mapped)
    {
        if (!(pdf > 0.0f)) return;
        const float through = so_far_ * share;
        of_lights_met_ = mapped ? 1.0f : through;
        if (!mapped) so_far_ = through + (wide ? (1.0f - narrow_share(pdf)) * (1.0f - through) : 0.0f);
    }

    // What is left to this ray: of lights met before the next vertex that is no delta;
    float of_lights() const { return 1.0f - of_lights_met_; }
    // of lights sampled at a vertex, or of caustic photons that come there through deltas alone. share: s of that light
    // there;
    float of_direct(float share) const { return 1.0f - so_far_ * share; }
    // of a photon of the caustic map. eye_share: s of the way from the eye;
    float of_caustic(PathClass photon, float share, float eye_share, bool wide) const
    {
        if (photon == PathClass::caustic) return of_direct(share);
        return wide ? of_direct(share) * (1.0f - eye_share) : 0.0f;
    }
    // of a photon of the global map where the vertex is mapped. goes_on: whether the ray may.
    float of_mapped(PathClass photon, float share, bool goes_on = true) const
    {
        if (photon == PathClass::direct || photon == PathClass::caustic || !goes_on) return of_direct(share);
        return 1.0f - share;
    }

private:
    float so_far_;  // what photons at earlier vertices have of light that comes to this one, were s = 1 here
    float of_lights_met_ = 0.0f;
};

}  // namespace dapple
