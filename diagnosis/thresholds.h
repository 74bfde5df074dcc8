// Every threshold, window, gain and band edge of the diagnosis that has a dimension: a dimensionless number times a scale of the
// machine (sim/machine/scales.h), so that one machine in another size is judged alike.
//
//   characteristic time T (scales.h)
//   frequencies           = shares of the highest structural mode that matters, or of 1 / T
//   torques               = shares of the rated torque;  angles and ratios as they are
//
// Assumption: what the drives can do and what the structure does are of one order; the slower of the two rules the windows of time.
#pragma once

#include <vector>

#include "diagnosis/record.h"
#include "diagnosis/shadow.h"
#include "diagnosis/whitening.h"
#include "sim/machine/description.h"

namespace slewlab::diagnosis {

struct Thresholds {
  double time = 0.0;               // [s] T
  AdmissionSettings admission;
  ShadowSettings shadow;
  WhiteningSettings whitening;
  std::vector<double> band_edges;  // [Hz] rising, between the machine's groups of modes
  double highest_mode = 0.0;       // [Hz] above which fitted machines leave modes out
  double latency = 0.0;            // [s] standard deviation of what is unknown of the encoders' delay
  double coarse_latency = 0.0;     // [s] the same behind coarse counts, whose noise goes far into the torque
  double fitted_time = 0.0;        // [s] of all logs together that is fitted at most (stretch.h)
  double shortest_stretch = 0.0;   // [s] of one of them, below which it is not fitted at all
  double moment = 0.0;             // [s] length of a stretch that is named as a moment
  double spell_every = 0.0;        // [s] distance of the beginnings from which an effect of limited duration is tried
};

// Throws std::invalid_argument where the machine cannot be assembled.
Thresholds thresholds_of(const sim::MachineDescription& machine);

// [Hz] One edge at the lowest and the highest frequency that is judged, one between the load's pendulum and the structure, one
// wherever two neighbouring structural modes stand apart by more than half of the lower one: at their geometric mean.
// `pendulum` and `structural` rise; what lies outside the judged frequencies gives no edge.
std::vector<double> edges_between(const std::vector<double>& pendulum, const std::vector<double>& structural, double lowest, double highest);

}  // namespace slewlab::diagnosis
