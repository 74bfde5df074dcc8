#include "diagnosis/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "controller/effects/catalogue.h"
#include "diagnosis/admit.h"
#include "diagnosis/discrepancy.h"
#include "diagnosis/doubt.h"
#include "diagnosis/hidden_commands.h"
#include "diagnosis/hidden_effects.h"
#include "diagnosis/judged_grid.h"
#include "diagnosis/law_in_draws.h"
#include "diagnosis/model_step.h"
#include "diagnosis/parameters_alone.h"
#include "diagnosis/ranking.h"
#include "diagnosis/search_as_built.h"
#include "diagnosis/stochastic.h"
#include "diagnosis/validate_lead.h"
#include "diagnosis/weigh_fits.h"
#include "sim/effects/catalogue.h"

namespace slewlab::diagnosis {

namespace {

constexpr double kMostMachines = 1e6;   // that are spoken of: the chance is not known better
constexpr double kWorthASwing = 2e-3;  // [rad] of the load at a record's beginning: a five-hundredth of the rope's length
constexpr std::size_t kMoments = 8;    // that are named
// On a log of the wire both sides are exact; a thousandth leaves room for logs that were rounded.
constexpr double kSameTorque = 1e-3;
constexpr double kOfNoise = 1.5;  // of the deviation of torques that were measured or rounded; the integrals are told by one of them
// Occam's factor of one number, beside which an effect must tell: of one that is known to a twelfth of its prior.
constexpr double kOccam = 5.0;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Whether the nominal controller answers what was recorded.
void replay(const Problem& problem, const controller::ControllerSettings& controller, Diagnosis& diagnosis) {
  for (const Record& record : problem.records) {
    check_replayable(record);
    diagnosis.controller_replay.push_back(replay_controller(record, controller));
    const ControllerReplay& replay = diagnosis.controller_replay.back();
    diagnosis.has_controller |= !replay.difference.empty();
    if (replay.difference.empty()) {
      diagnosis.remarks.push_back(fmt::format("{}: begins in motion or just behind one, and the joystick never stands still for as long as a ramp may take; what the controller "
                                              "knew is not in the record, and its answers are not compared", record.name));
      continue;
    }
    if (replay.difference_rms > std::hypot(kSameTorque * replay.torque_rms, kOfNoise * std::sqrt(record.torque_noise))) diagnosis.controller_differs = true;
  }
}

// Effects of which these records could not name even the most visible size.
std::vector<std::string> not_excited(const Screening& screening, const EvidenceSettings& evidence) {
  const double visible = (told_from(static_cast<int>(screening.names.size()), evidence) + kOccam) / evidence.independent_share;
  std::vector<std::string> names;
  for (const auto& [name, square] : screening.visibility) {
    if (square < visible) names.push_back(name);
  }
  return names;
}

// Sums of the causes' probabilities by effect, by subsystem, and of nothing missing.
void add_up(const common::EffectCatalogue& known, Diagnosis& diagnosis) {
  std::map<std::string, double> by_subsystem, by_effect;
  diagnosis.probability_nothing = 0.0;
  for (const Cause& cause : diagnosis.causes) {
    if (cause.effects.empty()) diagnosis.probability_nothing += cause.probability;
    // Each of the names of indistinguishable causes is as likely as the others.
    const double share = cause.probability / static_cast<double>(1 + cause.also.size());
    std::vector<std::vector<std::string>> names = cause.also;
    names.push_back(cause.effects);
    for (const std::vector<std::string>& effects : names) {
      std::set<std::string> touched;
      for (const std::string& effect : effects) {
        touched.insert(std::string(common::name_of(known.at(effect).subsystem)));
        by_effect[effect] += share;
      }
      for (const std::string& subsystem : touched) by_subsystem[subsystem] += share;
    }
  }
  const auto falling = [](const std::map<std::string, double>& by_name) {
    std::vector<std::pair<std::string, double>> all(by_name.begin(), by_name.end());
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    return all;
  };
  diagnosis.lead_acts = 0.0;
  for (const Cause& cause : diagnosis.causes) {
    const Cause& first = diagnosis.causes.front();
    const bool has_all = first.effects.empty() ? cause.effects.empty() : std::all_of(first.effects.begin(), first.effects.end(), [&](const std::string& one) {
      return std::find(cause.effects.begin(), cause.effects.end(), one) != cause.effects.end();
    });
    if (has_all) diagnosis.lead_acts += cause.probability;
  }
  diagnosis.subsystems = falling(by_subsystem);
  diagnosis.effects = falling(by_effect);
}

// A cause that does not predict a record that nobody fitted is not the answer, however well it explains those that were: nobody knows what is.
void give_up_what_is_refuted(Diagnosis& diagnosis) {
  const bool is_refuted = std::any_of(diagnosis.unseen.begin(), diagnosis.unseen.end(), [](const UnseenRecord& one) { return !one.cause.empty() && !one.validation.holds; });
  if (!is_refuted || !diagnosis.causes.front().validation) return;
  diagnosis.refuted = diagnosis.causes.front().probability;
  diagnosis.probability_unknown += std::exchange(diagnosis.causes.front().probability, 0.0);
  sort_causes(diagnosis.causes);
}

// The answer in one line.
void name_answer(const Cause& first, Diagnosis& diagnosis) {
  diagnosis.gap = diagnosis.controller_differs || diagnosis.counts > 0.0 || diagnosis.probability_nothing + diagnosis.probability_hidden < 0.5;
  diagnosis.is_unknown = diagnosis.probability_unknown > first.probability;
  if (diagnosis.is_unknown) {
    diagnosis.verdict = "outside the catalogue (unknown): no known effect explains what is missing";
  } else if (first.effects.empty()) {
    diagnosis.verdict = "no effect is missing; parameters within their spread explain the records";
  } else {
    diagnosis.verdict = told_name(first);
  }
}

bool any_swings_outwards(const common::EffectCatalogue& catalogue, const std::vector<std::string>& without) {
  return std::any_of(catalogue.effects.begin(), catalogue.effects.end(), [&](const common::EffectAbout& about) {
    return about.swings_outwards && std::find(without.begin(), without.end(), about.name) == without.end();
  });
}

// Of torques that were measured, without what lies before them: it shows in none, and a lag that is not there would keep the measurement's noise from the machine.
DiagnosisSettings without_what_is_before_torques(DiagnosisSettings settings, const std::vector<Record>& records, const common::EffectCatalogue& catalogue, std::vector<std::string>& remarks) {
  const auto measured = std::find_if(records.begin(), records.end(), [](const Record& record) { return record.has_measured_torque; });
  if (measured == records.end()) return settings;
  std::string names;
  for (const common::EffectAbout& about : catalogue.effects) {
    if (!about.before_torque) continue;
    settings.without.emplace_back(about.name);
    names += (names.empty() ? "" : ", ") + std::string(about.name);
  }
  remarks.push_back(fmt::format("{}: of torques that were measured, with noise of {:.2g} Nm, nothing tells what lies before them: {}", measured->name, std::sqrt(measured->torque_noise), names));
  return settings;
}

// From the records to the problem that is fitted. Gives how their differences are whitened. Throws NotAdmitted.
WhiteningSettings take_records(const sim::MachineSettings& nominal, std::vector<Record> records, const DiagnosisSettings& settings, Problem& problem, Diagnosis& diagnosis) {
  for (Record& record : records) record.effects_from = effects_from(records, record);
  set_machine(nominal, records, problem);
  if (settings.noise_corner) problem.thresholds.whitening.noise_corner = *settings.noise_corner;
  const WhiteningSettings whitening = whitening_for(problem.thresholds, has_coarse_counts(records));
  diagnosis.followed = admit(std::move(records), whitening, problem, diagnosis.remarks);
  diagnosis.nuisances = problem.nuisances;
  diagnosis.commands_per_row = problem.commands_per_row;
  ModelSteps steps = steps_for_forces(problem, settings.without, settings.evidence);
  problem.force_steps = std::move(steps.of_differences);
  problem.column_steps = std::move(steps.of_columns);
  return whitening;
}

// That of the cause's effects; null where there is none.
const FitResult* fit_of(const std::vector<FitResult>& fits, const Cause& cause) {
  const auto fit = std::find_if(fits.begin(), fits.end(), [&](const FitResult& one) { return has_same_effects(one.point, cause.point); });
  return fit == fits.end() ? nullptr : &*fit;
}

// A cause that leads by draws which come the same way each time is none: what they follow is in no catalogue.
void give_up_draws_that_are_a_law(Problem& problem, const std::vector<FitResult>& fits, Ranking& ranking, std::vector<std::string>& remarks) {
  constexpr double kWorthALook = 0.05;  // probability, chosen
  bool is_told = false;
  for (Cause& cause : ranking.causes) {
    if (cause.probability < kWorthALook || stochastic_part(problem.catalogue, cause.point).empty()) continue;
    const FitResult* const fit = fit_of(fits, cause);
    if (fit == nullptr) continue;
    if (!law_in_draws(problem, *fit).is_law()) continue;
    if (!std::exchange(is_told, true)) remarks.push_back(fmt::format("{} has the size of what is missing, but what is missing answers to each command in the same way, as nothing that happens by chance does", name_of(cause)));
    take_away(1.0, false, cause, ranking);
  }
  sort_causes(ranking.causes);
}

// Whether gains of accelerometers need not be asked for.
bool is_nothing_likely(const Weighed& weighed) {
  constexpr double kLikely = 0.5;  // chosen
  return weighed.probabilities.candidate.front() > kLikely && weighed.causes.front().prior_chance >= kFarTogether;
}

// Parameters alone, and fits with so many effects at most, none of them stochastic.
std::vector<const FitResult*> with_laws(const common::EffectCatalogue& catalogue, const Found& found, std::size_t most) {
  std::vector<const FitResult*> fits{&found.nothing};
  for (const FitResult& fit : found.fits) {
    if (fit.point.effects.size() <= most && stochastic_part(catalogue, fit.point).empty()) fits.push_back(&fit);
  }
  return fits;
}

// Gains of the accelerometers beside parameters alone, and beside effects that leave more than noise, or parameters of another make.
std::vector<GainsFit> look_for_gains(Problem& problem, const Found& found, const Weighed& weighed) {
  std::vector<GainsFit> all;
  const auto look_beside = [&](const FitResult& fit) {
    if (std::optional<GainsFit> gains = fit_gains(problem, fit)) all.push_back(std::move(*gains));
  };
  look_beside(found.nothing);
  if (all.empty()) return all;
  for (const std::size_t i : fits_to_ask_beside(problem.catalogue, found.fits, weighed.answer(found.fits))) {
    if (found.fits[i].mean_square > 1.0 || is_of_another_make(problem.nuisances, weighed.causes[i + 1])) look_beside(found.fits[i]);
  }
  return all;
}

// The likeliest that are surely the answer, against everything that has one effect more at most; null where none are.
const GainsFit* gains_of_the_answer(const Problem& problem, const std::vector<GainsFit>& gains, const Found& found, const EvidenceSettings& evidence) {
  const GainsFit* best = nullptr;
  for (const GainsFit& one : gains) {
    if (!are_the_answer(problem, one, with_laws(problem.catalogue, found, one.fit.point.effects.size() + 1), evidence)) continue;
    if (best == nullptr || chance_of_gains(problem, one, best->fit, evidence) > 0.5) best = &one;
  }
  return best;
}

// Gains in the place of all of a cause. What takes more away beside an effect would beside the gains as well, so a cause of two is as likely against them as its likelier one.
GainsInstead in_place_of_all(const Problem& problem, const Found& found, const GainsFit& gains, const EvidenceSettings& evidence, const Cause& cause) {
  std::optional<double> chance;
  for (const FitResult* single : with_laws(problem.catalogue, found, 1)) {
    if (single->point.effects.empty() || !has_effect(cause.point.effects, single->point.effects.front().name)) continue;
    chance = std::min(chance.value_or(1.0), chance_of_gains(problem, gains, *single, evidence));
  }
  return {chance.value_or(0.0), "", in_words(gains.gains)};
}

// Gains in the place of all of a cause but for the effect that they were fitted beside.
GainsInstead in_place_of_the_rest(const Problem& problem, const Found& found, const GainsFit& gains, const EvidenceSettings& evidence, const Cause& cause) {
  const std::string& kept = gains.fit.point.effects.front().name;
  const FitResult* const fit = fit_of(found.fits, cause);
  if (fit == nullptr || cause.point.effects.size() < 2 || !has_effect(cause.point.effects, kept)) return {};
  return {chance_of_gains(problem, gains, *fit, evidence), kept, in_words(gains.gains)};
}

// Causes of the machine against gains of the accelerometers.
void weigh_against_gains(const Problem& problem, const Found& found, const std::vector<GainsFit>& gains, const EvidenceSettings& evidence, Ranking& ranking, std::vector<std::string>& remarks) {
  doubt_what_gains_do(
      [&](const Cause& cause) {
        GainsInstead likeliest;
        if (!stochastic_part(problem.catalogue, cause.point).empty()) return likeliest;
        for (const GainsFit& one : gains) {
          if (in_words(one.gains).empty()) continue;
          GainsInstead instead = (one.fit.point.effects.empty() ? in_place_of_all : in_place_of_the_rest)(problem, found, one, evidence, cause);
          if (instead.chance > likeliest.chance) likeliest = std::move(instead);
        }
        return likeliest;
      },
      ranking, remarks);
}

double longest_row(const Records& records) {
  double row = 0.0;  // [s]
  for (const Record& record : records) row = std::max(row, record.encoder_period);
  return row;
}

// From what was weighed to the causes as they are told: with what the controller and the encoders' counts show, doubted for what the evidence cannot
// know, and led by one that predicts. Gives whether the residual of parameters alone is no more than noise.
bool rank(Problem& problem, const WhiteningSettings& whitening, const std::optional<controller::ControllerSettings>& controller, const common::EffectCatalogue& of_the_controller, const Searched& searched, Weighed weighed,
          const std::vector<GainsFit>& gains, const DiagnosisSettings& settings, const EvidenceSettings& evidence, const Progress& tell, Diagnosis& diagnosis) {
  const Found& found = searched.found;
  const bool are_parameters_likely = weighed.causes.front().prior_chance >= kFarTogether;  // with nothing missing
  Ranking ranking{std::move(weighed.causes), weighed.probabilities.unknown};
  const double unknown_law = weighed.probabilities.unknown_law;
  merge_same_motion(found.same_as, ranking);
  if (diagnosis.controller_differs) {
    tell(kHoldOut.from, "fitting the controller");
    diagnosis.controller_causes = fit_controller(problem.records, *controller, settings.without, problem.is_stopped,
                                                 [&](std::size_t count, const std::function<void(std::size_t)>& work) { share_out(problem, count, work); });
    add_controller_causes(of_the_controller, diagnosis.controller_causes, ranking);
  }
  diagnosis.counts = add_counts(problem, settings.without, ranking);
  const bool is_nominal_enough = diagnosis.mean_square_nominal <= 1.0, is_machine_all = !diagnosis.controller_differs && diagnosis.counts == 0.0;
  if (is_nominal_enough && is_machine_all) settle_on_nothing(ranking);
  const bool is_nothing_left = found.nothing.mean_square <= 1.0 && are_parameters_likely && is_machine_all;
  if (is_nothing_left) doubt_the_unknown_below_the_noise(unknown_law, ranking);
  if (found.nothing.mean_square <= 1.0 && !are_parameters_likely && is_machine_all && !is_nominal_enough) {
    diagnosis.far_parameters = far_parameters(problem.nuisances, found.nothing.point.nuisance);
    sort_causes(ranking.causes);  // the first of them is told why it is doubted
    doubt_what_parameters_do_as_well(problem.catalogue, diagnosis.far_parameters, ranking, diagnosis.remarks);
  }
  doubt_what_no_machine_has(problem.catalogue, problem.nuisances, is_nominal_enough, is_nothing_left, ranking, diagnosis.remarks);
  Validator validator(problem, whitening, controller, found.nothing.point, are_parameters_likely);
  const auto validate = [&] {
    if (!settings.hold_out || ranking.causes.empty()) return;
    tell(kHoldOut.from, "fitting without the last record");
    std::optional<HeldOut> held_out = validator.validate_lead(ranking, diagnosis.remarks);
    if (held_out) diagnosis.held_out = std::move(held_out);
    if (is_nothing_left) doubt_the_unknown_below_the_noise(unknown_law, ranking);
  };
  validate();
  sort_causes(ranking.causes);
  give_up_draws_that_are_a_law(problem, found.fits, ranking, diagnosis.remarks);
  constexpr double kSlow = 5.0;  // lowest frequencies, chosen: up to the slowest load's pendulum
  const double slow = kSlow * problem.thresholds.whitening.lowest_frequency;
  doubt_what_an_offset_does(
      [&](const Cause& cause) {
        const FitResult* const fit = fit_of(found.fits, cause);
        return fit == nullptr ? ChannelShare{} : largest_slow_share(problem, searched.base.difference, fit->difference, slow);
      },
      slow, ranking, diagnosis.remarks);
  sort_causes(ranking.causes);
  weigh_against_gains(problem, found, gains, evidence, ranking, diagnosis.remarks);
  sort_causes(ranking.causes);
  doubt_draws_beside_a_law(problem.catalogue, evidence, ranking, diagnosis.remarks);
  doubt_chance_on_the_wire(problem.catalogue, may_hide_commands(problem.records, controller), ranking, diagnosis.remarks);
  if (problem.commands_per_row > 1) doubt_what_held_rows_do(problem.catalogue, longest_row(problem.records), ranking, diagnosis.remarks);
  if (!is_nothing_left) share_with_other_laws(ranking);
  if (controller && !diagnosis.has_controller) {
    leave_room_for_the_controller(of_the_controller.effects.size(), problem.catalogue.effects.size() + of_the_controller.effects.size(), evidence, ranking);
  }
  validate();  // whatever leads now may have been asked nothing yet
  calibrate_lead(ranking);
  sort_causes(ranking.causes);
  if (settings.hold_out) validator.validate_others(ranking);
  const Hidden hidden = hidden_effects(problem.catalogue, searched.screening.tried, static_cast<int>(searched.screening.names.size()), evidence);
  diagnosis.probability_hidden = leave_room_for_the_hidden(hidden, ranking);
  diagnosis.causes = std::move(ranking.causes);
  diagnosis.probability_unknown = ranking.unknown;
  if (!diagnosis.causes.empty() && diagnosis.causes.front().effects.empty()) {
    for (const auto& [effect, share] : hidden.effects) {
      if (share > 0.5) diagnosis.hidden.push_back(effect);
    }
  }
  return is_nothing_left;
}

// The fit whose residual nobody has explained: that of the answer, or of parameters alone where there is none. Null where the residual is only draws
// of its stochastic effects, which follow nothing.
const FitResult* unexplained_fit(const Problem& problem, const Found& found, const Diagnosis& diagnosis, const Cause& first) {
  if (!diagnosis.gap) return nullptr;
  if (diagnosis.is_unknown || first.point.effects.empty()) return &found.nothing;
  if (!stochastic_part(problem.catalogue, first.point).empty()) return nullptr;
  return fit_of(found.fits, first);
}

// What the answer's parameters say: swings of the load, and parameters that had to go farther than machines of one make differ.
void remark_parameters(const Problem& problem, const Point& answer, double prior_chance, Diagnosis& diagnosis) {
  if (!diagnosis.is_unknown && prior_chance < kFarTogether) {
    diagnosis.remarks.push_back(fmt::format("with this answer the parameters, and what swings when the records begin, are all together further off than in one machine of one make in {:.0f}; an effect that they imitate may hide in them",
                                            std::min(kMostMachines, 1.0 / prior_chance)));
  }
  std::string far;
  const std::vector<sim::Parameter>& parameters = problem.nuisances.parameters;
  for (std::size_t k = 0; k < std::min(answer.nuisance.size(), parameters.size()); ++k) {
    if (std::fabs(answer.nuisance[k]) < kFarOff) continue;
    far += fmt::format("{}{} {:+.0f} %", far.empty() ? "" : ", ", parameters[k].name, 100.0 * parameters[k].spread * answer.nuisance[k]);
  }
  for (std::size_t r = 0; r < problem.records.size(); ++r) {
    const double reach = swing_reach(problem.nuisances, answer.nuisance, r);
    if (reach < kWorthASwing) continue;
    diagnosis.remarks.push_back(fmt::format("{}: the load swings when the record begins, up to {:.1f} mrad from where it would hang still",
                                            problem.records[r].name, 1e3 * reach));
  }
  if (far.empty() && !diagnosis.is_unknown) return;
  diagnosis.remarks.push_back(
      fmt::format("cannot tell whether this is another crane than the nominal one: {}; check that the crane file is this crane's",
                  far.empty() ? "neither a known effect nor parameters within their spread explain it"
                              : "the best fit wants " + far + ", more than machines of one make differ"));
}

// A gap below the noise that the sensors are taken to have: what shows it.
void remark_below_the_noise(Diagnosis& diagnosis) {
  for (const std::string& variable : followed_variables(diagnosis.discrepancies)) {
    diagnosis.remarks.push_back(fmt::format("the residual of the parameters alone is no larger than the noise assumed of the sensors; but it follows the {}, as noise does not (ln of the odds {:.0f}): something is missing",
                                            variable, diagnosis.discrepancies.front().evidence));
  }
}

}  // namespace

sim::MachineSettings as_fitted(sim::MachineSettings nominal, const Diagnosis& diagnosis) {
  sim::MachineSettings machine = with_boom_elements(std::move(nominal), diagnosis.boom_elements);
  machine.crane = with_gains(machine.crane, diagnosis.gains);
  machine.effects.insert(machine.effects.end(), diagnosis.of_every_machine.begin(), diagnosis.of_every_machine.end());
  return machine;
}

namespace {

// With rows that have so many commands each, and accelerometers with these gains beside what the nominal machine has. Where other gains are the answer, no more than they.
Diagnosis diagnose_read_by(const std::vector<AccelerometerGain>& known_gains, int commands_per_row, const sim::MachineSettings& nominal_of_file, const std::optional<controller::ControllerSettings>& controller,
                           std::vector<Record> records, const DiagnosisSettings& asked, const Progress& progress, const std::function<bool()>& is_stopped, std::vector<Record> unseen) {
  sim::MachineSettings nominal = nominal_of_file;
  nominal.crane = with_gains(nominal.crane, known_gains);
  const auto start_time = std::chrono::steady_clock::now();
  std::mutex telling;
  const auto tell = [&](double share, const std::string& doing) {
    const std::lock_guard lock(telling);
    if (progress) progress(share, doing);
  };
  Diagnosis diagnosis;
  diagnosis.gains = known_gains;
  Problem problem;
  const DiagnosisSettings settings = without_what_is_before_torques(asked, records, sim::effects_for(nominal), diagnosis.remarks);
  problem.settings = settings.fit;
  problem.threads = settings.threads;
  if (is_stopped) problem.is_stopped = is_stopped;
  problem.commands_per_row = commands_per_row;
  WhiteningSettings whitening = take_records(nominal, std::move(records), settings, problem, diagnosis);

  if (!any_swings_outwards(problem.catalogue, settings.without)) problem.nuisances.outward_swing = 0.0;

  tell(0.0, "replaying the controller");
  if (controller) replay(problem, *controller, diagnosis);

  Searched searched = search_as_built(problem, whitening, settings.without, settings.search, diagnosis.remarks, tell);
  const FitResult& base = searched.base;
  const Screening& screening = searched.screening;
  const Found& found = searched.found;
  diagnosis.of_every_machine = std::move(searched.of_every_machine);
  diagnosis.boom_elements = problem.nominal.crane.boom.element_count;
  diagnosis.mean_square_nominal = searched.nominal_machine.mean_square;
  if (const std::optional<FitResult> begun = nominal_with_beginnings(problem, base)) diagnosis.mean_square_nominal = std::min(diagnosis.mean_square_nominal, begun->mean_square);
  diagnosis.mean_square_parameters = base.mean_square;
  diagnosis.moments = largest_moments(problem, base.point, kMoments);
  const Projector project(base.columns, prior_rows(problem, base.point), data_weight(base.difference, settings.fit));
  EvidenceSettings evidence = settings.evidence;
  evidence.independent_share = problem.settings.independent_share;
  diagnosis.not_excited = not_excited(screening, evidence);
  tell(kHoldOut.from, "looking for a law that is in no catalogue");
  const SmoothTorques smooth(problem, searched.best(problem.catalogue));
  Weighed weighed = weigh_fits(problem, found, smooth, screening.names.size(), evidence, diagnosis.has_controller);
  const auto count_work = [&] {
    diagnosis.simulations = problem.simulations;
    diagnosis.simulation_seconds = 1e-9 * static_cast<double>(problem.simulation_time);
    diagnosis.total_seconds = seconds_since(start_time);
  };
  std::vector<GainsFit> gains;
  if (known_gains.empty() && diagnosis.mean_square_nominal > 1.0 && !is_nothing_likely(weighed)) gains = look_for_gains(problem, found, weighed);
  if (const GainsFit* const of_the_answer = gains_of_the_answer(problem, gains, found, evidence)) {
    diagnosis.gains = of_the_answer->gains;
    count_work();
    return diagnosis;
  }
  diagnosis.least_mean_square = weighed.least_mean_square;
  diagnosis.difference_count = static_cast<double>(difference_count(problem));
  for (const Whitening& one : problem.whitening) diagnosis.log_stretch += log_stretch(one);
  // The gap lies where the most probable cause takes something away; where none does, where the residual is more than noise.
  const FitResult* const answer_fit = weighed.answer(found.fits);
  const bool is_taken = answer_fit != nullptr && !is_stochastic(problem.catalogue.at(answer_fit->point.effects[0].name));
  diagnosis.bands = bands_of_gap(problem, base.difference, is_taken ? answer_fit->difference : Eigen::VectorXd::Ones(base.difference.size()));
  find_groups(problem, base, project, found.fits, std::span(weighed.probabilities.candidate).subspan(1), std::span(weighed.causes).subspan(1));

  const double unknown_law = weighed.probabilities.unknown_law;
  const common::EffectCatalogue of_the_controller = controller ? controller::effects_for(*controller) : common::EffectCatalogue{};
  const common::EffectCatalogue known = joined(problem.catalogue, of_the_controller);
  const bool is_nothing_left = rank(problem, whitening, controller, of_the_controller, searched, std::move(weighed), gains, settings, evidence, tell, diagnosis);
  if (!unseen.empty()) tell(kFollow.from, "predicting what was not fitted");
  const Cause* const lead = diagnosis.causes.empty() || diagnosis.probability_unknown > diagnosis.causes.front().probability ? nullptr : &diagnosis.causes.front();
  UnseenRecords unseen_records(problem, whitening, controller, found.nothing.point, std::move(unseen), diagnosis.remarks);
  diagnosis.unseen = unseen_records.judge(lead);
  give_up_what_is_refuted(diagnosis);
  if (!diagnosis.refuted && lead != nullptr) lead_by_what_is_unseen(unseen_records, diagnosis.mean_square_parameters, diagnosis.causes, diagnosis.probability_unknown, diagnosis.unseen, diagnosis.remarks);
  add_up(known, diagnosis);
  static const Cause kNone;
  const Cause& first = diagnosis.causes.empty() ? kNone : diagnosis.causes.front();
  name_answer(first, diagnosis);
  if (controller && !diagnosis.has_controller && !diagnosis.gap) diagnosis.verdict += "; what the controller answered could not be compared";
  if (const FitResult* const left = unexplained_fit(problem, found, diagnosis, first)) {
    tell(kFollow.from, "looking for what the rest follows");
    const bool is_fitted = diagnosis.is_unknown && unknown_law > 0.5;
    diagnosis.discrepancies = is_fitted ? smooth.of_residual(problem, *left, evidence.law_share) : discrepancies(problem, *left, smooth, evidence.law_share);
    if (is_fitted && is_nothing_left) remark_below_the_noise(diagnosis);
  }
  for (const common::EffectInstance& one : diagnosis.of_every_machine) {
    diagnosis.remarks.push_back(fmt::format("the records show {} ({}), which every machine has and a linear model leaves out: taken as a part of this one, no cause", one.name,
                                            known.at(one.name).physics));
  }
  const Point& answer = first.point.nuisance.empty() ? base.point : first.point;
  remark_parameters(problem, answer, first.prior_chance, diagnosis);

  Point followed = answer;
  const auto is_fitted = [&](const common::EffectInstance& effect) { return has_fit(known.at(effect.name)); };
  std::erase_if(followed.effects, [&](const common::EffectInstance& effect) { return !is_fitted(effect); });
  diagnosis.followed.explained = shadow_at(problem, followed, problem.records.size() - 1);
  count_work();
  tell(1.0, "done");
  return diagnosis;
}

void add_work(const Diagnosis& other, Diagnosis& diagnosis) {
  diagnosis.simulations += other.simulations;
  diagnosis.simulation_seconds += other.simulation_seconds;
  diagnosis.total_seconds += other.total_seconds;
}

// With rows that have so many commands each; on a machine whose accelerometers read otherwise than its file has it, where that is what the records show.
Diagnosis diagnose_with(int commands_per_row, const sim::MachineSettings& nominal, const std::optional<controller::ControllerSettings>& controller, std::vector<Record> records, const DiagnosisSettings& settings,
                        const Progress& progress, const std::function<bool()>& is_stopped, std::vector<Record> unseen) {
  const bool has_gains = std::any_of(records.begin(), records.end(), [](const Record& record) {
    return std::any_of(record.acceleration.begin(), record.acceleration.end(), [](const auto& one) { return !one.empty(); });
  });
  if (!has_gains) return diagnose_read_by({}, commands_per_row, nominal, controller, std::move(records), settings, progress, is_stopped, std::move(unseen));
  Diagnosis by_the_file = diagnose_read_by({}, commands_per_row, nominal, controller, records, settings, progress, is_stopped, unseen);
  if (by_the_file.gains.empty()) return by_the_file;
  constexpr Stage kOnceMore{kHoldOut.from, 1.0};
  Diagnosis answer = diagnose_read_by(by_the_file.gains, commands_per_row, nominal, controller, std::move(records), settings, within(progress, kOnceMore), is_stopped, std::move(unseen));
  add_work(by_the_file, answer);
  answer.remarks.push_back(fmt::format("accelerometers read by other gains than the machine's file has: {}; taken as a part of this machine, no cause. Calibrate them, or give their gains in the file (`sensors:`)", in_words(answer.gains)));
  return answer;
}

// Whether commands may have come between rows that are as far apart as the points at which the machine is judged.
bool are_rows_too_few(const sim::MachineSettings& nominal, const std::vector<Record>& records, const std::optional<controller::ControllerSettings>& controller) {
  const double highest = thresholds_of(sim::describe(nominal.crane)).whitening.highest_frequency;
  return may_hide_commands(records, controller) &&
         std::any_of(records.begin(), records.end(), [&](const Record& record) { return can_have_commands_between(record) && points_per_judged_point(record, highest) == 1; });
}

// Whether the first cause, or parameters alone, leave noise alone, and are no stochastic effect of the wire, which commands between the rows look like.
bool is_answered(const common::EffectCatalogue& catalogue, const Diagnosis& diagnosis) {
  if (diagnosis.is_unknown || diagnosis.causes.empty()) return false;
  const Cause& first = diagnosis.causes.front();
  return first.mean_square <= kNoiseAlone && std::none_of(first.effects.begin(), first.effects.end(), [&](const std::string& name) { return is_chance_on_the_wire(catalogue, name); });
}

// Whether the records are likelier by the first cause with commands between their rows than by whatever leaves least without them: by the density of what they differ by (whitening.h).
bool is_likelier(const common::EffectCatalogue& catalogue, const Diagnosis& between, const Diagnosis& as_written) {
  const auto surprise = [](const Diagnosis& diagnosis, double mean_square) { return mean_square * diagnosis.difference_count - diagnosis.log_stretch; };
  const Cause& first = between.causes.front();
  // The residual beside a draw is divided by its power.
  const double left = stochastic_part(catalogue, first.point).empty() ? first.mean_square : between.least_mean_square;
  return between.difference_count == as_written.difference_count && surprise(between, left) < surprise(as_written, as_written.least_mean_square);
}

// With commands between the rows; nothing where the records cannot be judged so. What the controller answered to readings that no row has cannot be compared.
std::optional<Diagnosis> diagnose_between(const sim::MachineSettings& nominal, std::vector<Record> records, const DiagnosisSettings& settings, const Progress& progress,
                                          const std::function<bool()>& is_stopped, std::vector<Record> unseen) {
  try {
    return diagnose_with(kSomeCommands, nominal, std::nullopt, std::move(records), settings, progress, is_stopped, std::move(unseen));
  } catch (const NotAdmitted&) {
    return {};
  }
}

}  // namespace

Diagnosis diagnose(const sim::MachineSettings& nominal, const std::optional<controller::ControllerSettings>& controller,
                   std::vector<Record> records, const DiagnosisSettings& settings, const Progress& progress,
                   const std::function<bool()>& is_stopped, std::vector<Record> unseen) {
  constexpr Stage kAsWritten{0.0, 0.5}, kWithCommandsBetween{0.5, 1.0};
  if (!are_rows_too_few(nominal, records, controller)) return diagnose_with(1, nominal, controller, std::move(records), settings, progress, is_stopped, std::move(unseen));
  const common::EffectCatalogue catalogue = sim::effects_for(nominal);
  Diagnosis as_written = diagnose_with(1, nominal, controller, records, settings, within(progress, kAsWritten), is_stopped, unseen);
  if (is_answered(catalogue, as_written)) return as_written;
  std::optional<Diagnosis> between = diagnose_between(nominal, std::move(records), settings, within(progress, kWithCommandsBetween), is_stopped, std::move(unseen));
  if (!between) return as_written;
  const bool is_taken = is_answered(catalogue, *between) && is_likelier(catalogue, *between, as_written);
  Diagnosis &answer = is_taken ? *between : as_written, &other = is_taken ? as_written : *between;
  add_work(other, answer);
  if (is_taken) {
    answer.remarks.push_back(fmt::format("the controller seems to be faster than the recorder: with commands between the rows, of which nobody knows more than that they lie about a smooth course through the rows, what is missing "
                                         "has an answer; if the rows are all of its commands, the answer is another one: {}. Record every command, or give the controller, to tell which",
                                         as_written.is_unknown ? "unknown" : fmt::format("{} ({:.0f} %)", as_written.verdict, 100.0 * as_written.causes.front().probability)));
  }
  return std::move(answer);
}

}  // namespace slewlab::diagnosis
