#include "diagnosis/doubt.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "diagnosis/coordinates.h"
#include "diagnosis/evidence.h"
#include "diagnosis/stochastic.h"
#include "diagnosis/validate.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kUnknownBelowNoise = 0.4;  // of the probability that no known effect is missing, where parameters' residual is noise alone and no law was fitted
constexpr double kHiding = 1e-3;         // of machines with parameters that are not of their make's, or with something that hides in them; learned
constexpr double kMostTaken = 0.9;       // of a cause, by that: it may be one of that make all the same
constexpr double kOtherLawTemper = 5.0;     // chosen: by which the evidence among laws that are another one than the catalogue's counts less
// How sure a lead is at most, by how often it was right on machines that no score uses (docs/history/diagnosis.md). Where one effect is the answer,
// parameters or that effect hid a second one so often (kHiddenBeside). Where the residual of the answer is more than the noise can be off by, it was
// another one so often (kAboveTheNoise). Where parameters alone have such a residual, something small is so likely (kSmallBesideNothing).
constexpr double kHiddenBeside = 0.12, kAboveTheNoise = 0.25, kSmallBesideNothing = 0.25;
constexpr double kClearLead = 0.6;  // probability, beyond which no other answer can come to lead by that

// Of a cause's probability, that something else hides in its parameters, of which one machine in 1 / `chance` has such: the odds of the two.
double share_that_hides(double chance) { return std::clamp(kHiding / (kHiding + chance), kDoubtTakes, kMostTaken); }

}  // namespace

bool is_of_another_make(const Nuisances& nuisances, const Cause& cause) {
  const auto parameters = cause.point.nuisance.begin();
  const auto count = static_cast<std::ptrdiff_t>(std::min(cause.point.nuisance.size(), nuisances.parameters.size()));
  return cause.prior_chance < kFarTogether || std::any_of(parameters, parameters + count, [](double amount) { return std::fabs(amount) > kFarOff; });
}

void settle_on_nothing(Ranking& ranking) {
  for (Cause& cause : ranking.causes) cause.probability = cause.effects.empty() ? 1.0 : 0.0;
  ranking.unknown = 0.0;
}

void doubt_the_unknown_below_the_noise(double unknown_law, Ranking& ranking) {
  Cause* const nothing = nothing_missing(ranking);
  if (nothing == nullptr) return;
  const double fitted = std::min(ranking.unknown, kOutsideTheCatalogue * unknown_law);
  const double rest = ranking.unknown - fitted, both = nothing->probability + rest;
  const double kept = std::min(rest, kUnknownBelowNoise * std::max(0.0, both - (1.0 - kOutsideTheCatalogue) * unknown_law));
  nothing->probability = both - kept;
  ranking.unknown = fitted + kept;
}

void doubt_what_no_machine_has(const common::EffectCatalogue& catalogue, const Nuisances& nuisances, bool is_nominal_enough, bool is_nothing_left, Ranking& ranking,
                               std::vector<std::string>& remarks) {
  constexpr double kAtTheEnd = 1e-6;  // of the range
  for (Cause& cause : ranking.causes) {
    const bool is_nothing = cause.effects.empty();
    if (is_nothing && is_nominal_enough) continue;  // with every parameter where the file has it
    // What the draws of a stochastic effect do no law says: they take the parameters along.
    const double share = stochastic_part(catalogue, cause.point).empty() ? share_that_hides(cause.prior_chance) : kDoubtTakes;
    if (is_of_another_make(nuisances, cause)) take_away(share, is_nothing_left && !is_nothing, cause, ranking);
    for (const common::EffectInstance& effect : cause.point.effects) {
      const common::EffectAbout& about = catalogue.at(effect.name);
      // Of its size: shares and shapes may well lie at an end of theirs.
      const common::EffectParameter& parameter = about.parameters[common::kSize];
      const double range = parameter.upper - parameter.lower, value = effect.values[common::kSize];
      if (!std::isfinite(range) || is_all_round(parameter)) continue;
      const bool is_at_upper = value > parameter.upper - kAtTheEnd * range;
      const bool is_at_lower = value < parameter.lower + kAtTheEnd * range && !(parameter.absent && *parameter.absent <= parameter.lower);
      const std::string name = fmt::format("{}.{}", effect.name, parameter.name);
      const auto size = std::find_if(cause.sizes.begin(), cause.sizes.end(), [&](const Size& one) { return one.parameter == name; });
      const bool is_undetermined = size != cause.sizes.end() && (size->low < parameter.lower || size->high > parameter.upper);
      if (is_undetermined) {
        size->low = std::max(size->low, parameter.lower);
        size->high = std::min(size->high, parameter.upper);
      }
      const bool may_not_act = size != cause.sizes.end() && size->may_be_none;
      if (!is_at_upper && !is_at_lower && !is_undetermined && !may_not_act) continue;
      if (&cause == &ranking.causes.front()) {
        std::string told = fmt::format("{}: the 90 % interval goes beyond what it can be; these records do not determine it", name);
        if (is_at_upper || is_at_lower) told = fmt::format("{} was fitted to the {} end of its range, {:.3g} {}", name, is_at_upper ? "upper" : "lower", value, common::name_of(parameter.unit));
        else if (!is_undetermined) told = fmt::format("{}: these records do not tell it from {:.3g} {}, where the effect is absent", name, *parameter.absent, common::name_of(parameter.unit));
        remarks.push_back(std::move(told));
      }
      hand_on(kDoubtTakes, [&](const std::string& one) { return one == effect.name; }, is_nothing_left, cause, ranking);
    }
  }
}

void doubt_what_parameters_do_as_well(const common::EffectCatalogue& catalogue, const std::vector<FarParameter>& far, Ranking& ranking, std::vector<std::string>& remarks) {
  if (far.empty()) return;
  const auto says_what_a_parameter_is = [&](const common::EffectInstance& effect) { return !catalogue.at(effect.name).stands_for.empty(); };
  for (Cause& cause : ranking.causes) {
    const std::vector<common::EffectInstance>& effects = cause.point.effects;
    if (effects.empty() || std::any_of(effects.begin(), effects.end(), says_what_a_parameter_is)) continue;
    if (&cause == &ranking.causes.front()) {
      remarks.push_back(fmt::format("{} is not sure: parameters alone leave no more than noise either, farther off than machines of one make differ ({}); check these numbers of the machine's file first", name_of(cause),
                                    in_words(far)));
    }
    take_away(kDoubtTakes, false, cause, ranking);
  }
}

void doubt_draws_beside_a_law(const common::EffectCatalogue& catalogue, const EvidenceSettings& evidence, Ranking& ranking, std::vector<std::string>& remarks) {
  const auto is_drawn = [&](const std::string& effect) { return is_stochastic(catalogue, effect); };
  for (Cause& cause : ranking.causes) {
    std::vector<std::string> drawn, rest;
    std::partition_copy(cause.effects.begin(), cause.effects.end(), std::back_inserter(drawn), std::back_inserter(rest), is_drawn);
    if (drawn.empty() || rest.empty()) continue;
    const auto alone = std::find_if(ranking.causes.begin(), ranking.causes.end(), [&](const Cause& other) { return std::is_permutation(other.effects.begin(), other.effects.end(), rest.begin(), rest.end()); });
    if (alone == ranking.causes.end() || cause.explained - alone->explained > evidence.unknown_share) continue;
    if (&cause == &ranking.causes.front()) {
      remarks.push_back(fmt::format("{} adds {:.1f} % to the share of the gap explained on the fitted records, beside {}; the residual is as large where a law differs from that of the catalogue, so {} alone may be the cause", name_of(drawn),
                                    100.0 * (cause.explained - alone->explained), name_of(rest), name_of(rest)));
    }
    hand_on(kDoubtTakes, is_drawn, false, cause, ranking);
  }
}

bool is_chance_on_the_wire(const common::EffectCatalogue& catalogue, const std::string& name) {
  const common::EffectAbout* about = catalogue.find(name);
  return about != nullptr && is_stochastic(*about) && about->subsystem == common::Subsystem::wire;
}

void doubt_chance_on_the_wire(const common::EffectCatalogue& catalogue, bool may_hide_commands, Ranking& ranking, std::vector<std::string>& remarks) {
  if (!may_hide_commands) return;
  const auto is_such = [&](const std::string& name) { return is_chance_on_the_wire(catalogue, name); };
  bool is_told = false;
  for (Cause& cause : ranking.causes) {
    const auto found = std::find_if(cause.effects.begin(), cause.effects.end(), is_such);
    if (found == cause.effects.end()) continue;
    if (!std::exchange(is_told, true)) {
      remarks.push_back(fmt::format("{} is not sure: the commands change with every row, so the controller may be faster than the recorder, and commands between the rows do the same; record every command, or give the controller",
                                    *found));
    }
    hand_on(kDoubtTakes, is_such, false, cause, ranking);
  }
}

void doubt_what_held_rows_do(const common::EffectCatalogue& catalogue, double row, Ranking& ranking, std::vector<std::string>& remarks) {
  bool is_told = false;
  for (Cause& cause : ranking.causes) {
    const auto is_within_a_row = [&](const common::EffectInstance& effect) { return is_steady_delay(catalogue.at(effect.name)) && effect.values[common::kSize] < row; };
    const auto is_such = [&](const std::string& name) {
      return std::any_of(cause.point.effects.begin(), cause.point.effects.end(), [&](const common::EffectInstance& effect) { return effect.name == name && is_within_a_row(effect); });
    };
    const auto found = std::find_if(cause.effects.begin(), cause.effects.end(), is_such);
    if (found == cause.effects.end()) continue;
    if (!std::exchange(is_told, true)) {
      remarks.push_back(fmt::format("{} is not sure: it acts late by less than a row of the record ({:.3g} s), and so do rows that are all of the controller's commands and hold until the next; record every command, or give the controller",
                                    *found, row));
    }
    hand_on(kDoubtTakes, is_such, false, cause, ranking);
  }
}

void doubt_what_an_offset_does(const std::function<ChannelShare(const Cause&)>& share_of, double slow, Ranking& ranking, std::vector<std::string>& remarks) {
  constexpr double kMostOfIt = 0.7;  // chosen
  bool is_told = false;
  for (Cause& cause : ranking.causes) {
    if (cause.effects.empty() || cause.probability == 0.0) continue;
    const ChannelShare seen = share_of(cause);
    if (seen.share < kMostOfIt) continue;
    if (!std::exchange(is_told, true)) {
      remarks.push_back(fmt::format("{} is not sure: {:.0f} % of what it explains is in the {} below {:.2g} Hz, and an offset of that sensor that wanders does the same; look at what it reads while the machine stands",
                                    name_of(cause), 100.0 * seen.share, seen.channel, slow));
    }
    take_away(kDoubtTakes, false, cause, ranking);
  }
}

void doubt_what_gains_do(const std::function<GainsInstead(const Cause&)>& instead_of, Ranking& ranking, std::vector<std::string>& remarks) {
  constexpr double kWorthTelling = 0.1;  // chosen
  bool is_told = false;
  for (Cause& cause : ranking.causes) {
    if (cause.effects.empty() || cause.probability == 0.0) continue;
    const GainsInstead instead = instead_of(cause);
    if (instead.chance > kWorthTelling && !std::exchange(is_told, true)) {
      const std::string beside = instead.beside.empty() ? "" : " beside " + instead.beside;
      remarks.push_back(fmt::format("{} is not sure: accelerometers that read by other gains than the machine's file has explain the records as well{}: {}. Calibrate them, or give their gains in the file (`sensors:`)",
                                    name_of(cause), beside, instead.gains));
    }
    hand_on(instead.chance, [&](const std::string& effect) { return effect != instead.beside; }, false, cause, ranking);
  }
}

void share_with_other_laws(Ranking& ranking) {
  const auto weight = [](const Cause& cause) { return cause.effects.empty() ? 0.0 : std::pow(cause.probability * (1.0 - cause.with_unknown_law), 1.0 / kOtherLawTemper); };
  double sum = 0.0;
  for (const Cause& cause : ranking.causes) sum += weight(cause);
  if (!(sum > 0.0)) return;
  const double shared = (1.0 - kOutsideTheCatalogue) * ranking.unknown;
  ranking.unknown -= shared;
  for (Cause& cause : ranking.causes) {
    const bool may_lead = cause.validation && cause.validation->holds;
    const double share = shared * weight(cause) / sum, room = std::max(0.0, ranking.unknown - cause.probability);
    const double taken = may_lead ? share : std::min(share, room);
    cause.probability += taken;
    ranking.unknown += share - taken;
  }
}

void leave_room_for_the_controller(std::size_t of_the_controller, std::size_t all, const EvidenceSettings& evidence, Ranking& ranking) {
  Cause* const nothing = nothing_missing(ranking);
  if (nothing == nullptr || all == 0) return;
  const double share = static_cast<double>(of_the_controller) / static_cast<double>(all);
  const double room = evidence.prior_single * share + evidence.prior_pair * (1.0 - (1.0 - share) * (1.0 - share));
  take_away(room / (evidence.prior_nothing + room), false, *nothing, ranking);
}

double leave_room_for_the_hidden(const Hidden& hidden, Ranking& ranking) {
  if (ranking.causes.empty() || !ranking.causes.front().effects.empty()) return 0.0;
  Cause& nothing = ranking.causes.front();
  const double next = ranking.causes.size() > 1 ? ranking.causes[1].probability : 0.0;
  const double spare = nothing.probability - std::max(next, ranking.unknown);
  const double room = std::clamp(nothing.probability * hidden.odds / (1.0 + hidden.odds), 0.0, std::max(0.0, spare));
  nothing.probability -= room;
  return room;
}

void calibrate_lead(Ranking& ranking) {
  sort_causes(ranking.causes);
  if (ranking.causes.empty()) return;
  Cause& lead = ranking.causes.front();
  if (ranking.unknown >= lead.probability) return;
  const double above = std::clamp((lead.mean_square - 1.0) / kNoise, 0.0, 1.0);
  if (lead.effects.empty()) {
    const double room = kSmallBesideNothing * above;
    return take_away(room / (1.0 + room), false, lead, ranking);
  }
  const double spare = std::max(0.0, 1.0 - ranking.unknown / lead.probability);
  take_away(std::min(kAboveTheNoise * above, 0.5 * spare), false, lead, ranking);
  if (lead.effects.size() > 1 || lead.probability < kClearLead) return;
  hand_on(kHiddenBeside, [](const std::string&) { return false; }, false, lead, ranking);
}

}  // namespace slewlab::diagnosis
