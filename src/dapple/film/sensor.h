// From lanes to sensor RGB: pbrt's sensor and exposure model.
#pragma once

#include "dapple/math/vec.h"
#include "dapple/spectrum/spectrum.h"
#include "dapple/spectrum/wavelengths.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dapple {

struct Sensor {
    float imaging_ratio = 1.0f;  // exposure time * ISO / 100
    // Output RGB (linear, the film's colour space) of radiance at each wavelength, in steps of 1 nm from lambda_min.
    std::vector<Vec3> rgb;

    // Output RGB of radiance L [W/(m2 sr nm)]: mean over lanes of response * L / pdf, times the imaging ratio, to the
    // output colour space. In the rgb model: L's first three lanes times the imaging ratio.
    Vec3 to_rgb(const Spectrum& radiance, const Wavelengths& wavelengths) const
    {
        return LaneColors(*this, wavelengths).to_rgb(radiance);
    }

    // The output RGB of each lane at some wavelengths, for whoever converts more than one radiance there.
    class LaneColors {
    public:
        LaneColors(const Sensor& sensor, const Wavelengths& wavelengths);
        Vec3 to_rgb(const Spectrum& radiance) const
        {
            return color_[0] * radiance[0] + color_[1] * radiance[1] + color_[2] * radiance[2] +
                   color_[3] * radiance[3];
        }

    private:
        Vec3 color_[Spectrum::lanes];
    };
};

// The sensor named as pbrt names it ("cie1931", "canon_eos_5d_mkiv", ...), for an output colour space name. Throws
// UserError for an unknown name. white_balance in kelvin, 0: none for cie1931, 6500 for the others.
Sensor make_sensor(const std::string& name, const std::string& color_space, float white_balance, float imaging_ratio);

}  // namespace dapple
