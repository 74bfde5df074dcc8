// The manoeuvre that tells most about which of several hypotheses is true: each of them, as fitted, runs each candidate in closed loop, and
// what an answer to the question "which of them" would be worth is
//
//   gain = -sum over i of p_i log2( sum over j of p_j exp(-D_ij / (8 T)) )   [bits],
//   D_ij = s sum over signals and samples of (difference)^2 / ((noise floor)^2 + (e RMS)^2),
//
// a lower bound of the mutual information between hypothesis and record (Kolchinsky, Tracey 2017, with the Bhattacharyya distance of two normal
// distributions of one covariance); s, e and T as in the whitening and the evidence. It is at most the entropy of the p_i. Of manoeuvres that are as good the one is
// taken whose hypotheses are farther apart.
// Assumption: the parameters of each hypothesis are as fitted; what they could still move by is not taken off the differences.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "diagnosis/discriminate.h"
#include "diagnosis/record.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::diagnosis {

// What may be true: a machine with its controller.
struct Hypothesis {
  std::string name;
  double probability = 0.0;
  sim::MachineSettings machine;
  controller::ControllerSettings controller;
};

struct NextManoeuvre {
  Manoeuvre manoeuvre;
  double gain = 0.0;     // [bits] expected
  double open = 0.0;     // [bits] entropy of the hypotheses: what is not known now
  std::string first, second;  // the two likeliest, and the signal in which they differ most
  Separation separation;
};

// Speed requests within the controller's range and at most so many; the last one is a stop, long enough before the end for the load to be seen swinging.
std::vector<Manoeuvre> candidate_manoeuvres(int random_ones, std::uint64_t seed);

// `like` tells what is recorded: which accelerometers. `hypotheses` are at least two. Asks `is_stopped` before every run and throws
// Interrupted; std::invalid_argument for fewer than two hypotheses.
NextManoeuvre next_manoeuvre(const std::vector<Hypothesis>& hypotheses, const std::vector<Manoeuvre>& candidates, const Record& like,
                             const std::function<bool()>& is_stopped = {});

// What an answer is worth: see above. `distance` is D_ij, `probability` need not sum to 1.
double expected_gain(const std::vector<double>& probability, const std::vector<std::vector<double>>& distance);  // [bits]
double entropy(const std::vector<double>& probability);                                                           // [bits]

// The manoeuvre as a scenario that `slewlab run` takes; paths as they are written there.
std::string scenario_text(const NextManoeuvre& next, const std::string& crane, const std::string& controller,
                          const controller::ControllerSettings& settings, double plant_step);

}  // namespace slewlab::diagnosis
