// Every algorithm, one line each; registry.cpp lists them in the order of the help.
#pragma once

#include "dapple/integrators/integrator.h"

namespace dapple {

extern const IntegratorEntry path_tracing_entry;
extern const IntegratorEntry light_tracing_entry;
extern const IntegratorEntry photon_mapping_entry;
extern const IntegratorEntry irradiance_caching_entry;
extern const IntegratorEntry bdpt_entry;
extern const IntegratorEntry vcm_entry;
extern const IntegratorEntry progressive_photon_mapping_entry;
extern const IntegratorEntry photon_splatting_entry;

}  // namespace dapple
