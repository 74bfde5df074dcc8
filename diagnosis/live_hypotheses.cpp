#include "diagnosis/live_hypotheses.h"

#include "controller/effects/catalogue.h"

namespace slewlab::diagnosis {

namespace {

// Causes that a next manoeuvre should tell apart, and from how many that are drawn it is chosen.
constexpr double kLive = 0.02;  // probability
constexpr std::size_t kMostHypotheses = 4;
constexpr int kDrawnManoeuvres = 12;

}  // namespace

bool is_sure(const Diagnosis& found) {
  if (!found.gap) return found.probability_nothing + found.probability_hidden >= kSure;
  if (found.is_unknown || found.causes.empty()) return false;
  const Cause& first = found.causes.front();
  return found.lead_acts >= kSure && first.group.empty();
}

std::vector<Hypothesis> live_hypotheses(const sim::MachineSettings& nominal, const controller::ControllerSettings& controller,
                                        const Diagnosis& found, const Record& like) {
  std::vector<Hypothesis> hypotheses;
  for (const Cause& cause : found.causes) {
    if (cause.probability < kLive || hypotheses.size() == kMostHypotheses) break;
    controller::ControllerSettings with = controller::with_effects(controller, cause.controller_effects);
    with.period = like.encoder_period;
    hypotheses.push_back({name_of(cause), cause.probability, machine_at(nominal, found.nuisances, cause.point), with});
  }
  return hypotheses;
}

std::optional<NextManoeuvre> manoeuvre_after(const sim::MachineSettings& nominal, const controller::ControllerSettings& controller,
                                             const Diagnosis& found, const Record& like, const std::function<bool()>& is_stopped) {
  if (is_sure(found)) return {};
  const std::vector<Hypothesis> hypotheses = live_hypotheses(nominal, controller, found, like);
  if (hypotheses.size() < 2) return {};
  return next_manoeuvre(hypotheses, candidate_manoeuvres(kDrawnManoeuvres, 1), like, is_stopped);
}

}  // namespace slewlab::diagnosis
