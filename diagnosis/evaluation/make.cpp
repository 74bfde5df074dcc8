#include "diagnosis/evaluation/make.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/yaml_file.h"
#include "common/yaml_text.h"
#include "controller/controller_file.h"
#include "diagnosis/evaluation/known_laws.h"
#include "diagnosis/evaluation/measure.h"
#include "diagnosis/evaluation/seal.h"
#include "diagnosis/evaluation/side_by_side.h"
#include "msgs/codec.h"
#include "msgs/configuration_hash.h"
#include "msgs/run_identity.h"
#include "msgs/log_writer.h"
#include "sim/machine/description.h"
#include "sim/machine/machine_file.h"

namespace slewlab::diagnosis::withheld {

namespace fs = std::filesystem;
using nlohmann::json;

std::string case_name(int number) {
  char text[32];
  std::snprintf(text, sizeof text, "case_%04d", number);
  return text;
}

namespace {

constexpr std::array<const char*, 3> kLogNames{"a.lcmlog", "b.lcmlog", "unseen.lcmlog"};
constexpr double kImpactTime = 2.0;  // [s] that visibility leaves out from a contact change on, stretched as the manoeuvres are

std::vector<double> column(const TruthRun& run, double SensorValues::* value) {
  std::vector<double> values;
  for (const SensorValues& sensors : run.sensors) values.push_back(sensors.*value);
  return values;
}

constexpr std::array<const char*, 3> kSensorNames{"all", "tip", "none"};
constexpr std::array<const char*, 2> kLawsNames{"withheld", "known"};

bool is_recorded(Sensors sensors, std::string_view place) { return sensors == Sensors::kAll || (sensors == Sensors::kTip && place == "tip"); }

}  // namespace

const char* name_of(Sensors sensors) { return kSensorNames[static_cast<std::size_t>(sensors)]; }

Sensors sensors_named(const std::string& name) {
  for (std::size_t k = 0; k < kSensorNames.size(); ++k) {
    if (name == kSensorNames[k]) return static_cast<Sensors>(k);
  }
  throw std::invalid_argument("sensors are \"all\", \"tip\" or \"none\", not \"" + name + "\"");
}

const char* name_of(Laws laws) { return kLawsNames[static_cast<std::size_t>(laws)]; }

Laws laws_named(const std::string& name) {
  for (std::size_t k = 0; k < kLawsNames.size(); ++k) {
    if (name == kLawsNames[k]) return static_cast<Laws>(k);
  }
  throw std::invalid_argument("laws are \"withheld\" or \"known\", not \"" + name + "\"");
}

Visibility visibility(const TruthRun& with, const TruthRun& without, const TruthMachine& machine, Sensors sensors, double from) {
  Visibility best;
  const auto steps = std::min(with.sensors.size(), without.sensors.size());
  std::vector<bool> counts(steps, true);
  std::fill_n(counts.begin(), std::min(steps, static_cast<std::size_t>(std::lround(from / kBaseStep))), false);
  for (const TruthRun* run : {&with, &without}) {
    for (const double time : run->contact_change_times) {
      const auto begin = static_cast<std::size_t>(std::lround(time / kBaseStep));
      const auto end = std::min(steps, begin + static_cast<std::size_t>(std::lround(kImpactTime * machine.scales.stretch / kBaseStep)));
      for (std::size_t n = begin; n < end; ++n) counts[n] = false;
    }
  }
  const auto cycle = static_cast<std::size_t>(with.cycle_steps);
  const auto rms = [&](const std::vector<double>& a, const std::vector<double>& b, std::size_t per_value) {
    double sum = 0.0, number = 0.0;
    for (std::size_t n = 0; n < std::min(a.size(), b.size()) && n * per_value < steps; ++n) {
      if (!counts[n * per_value]) continue;
      sum += (a[n] - b[n]) * (a[n] - b[n]);
      number += 1.0;
    }
    return number == 0.0 ? 0.0 : std::sqrt(sum / number);
  };
  const auto consider = [&](const std::string& signal, double difference, double floor) {
    if (difference / floor > best.largest) best = {difference / floor, signal};
  };
  const double floor = counting_noise(machine.counting, machine.scales.top_shaft_speed);
  for (int i = 0; i < with.group_count; ++i) {
    const std::string group = " " + std::to_string(i + 1);
    consider("shaft speed" + group, rms(with.shaft_speed[i], without.shaft_speed[i], cycle), floor);
    consider("motor torque" + group, rms(with.motor_torque[i], without.motor_torque[i], cycle),
             floor * machine.controller.speed_control.proportional_gain);
  }
  for (const auto& sensor : kAccelerometers<SensorValues>) {
    if (!is_recorded(sensors, sensor.place)) continue;
    consider(std::string(sensor.place) + " acceleration", rms(column(with, sensor.value), column(without, sensor.value), 1), machine.noise.accelerometer);
  }
  return best;
}

void write_log(const TruthRun& run, const LogSettings& settings, const fs::path& file) {
  constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
  const std::int64_t hash = settings.configuration_hash;
  msgs::LogWriter writer(file);
  std::vector<std::uint8_t> bytes;
  const auto append = [&](const char* channel, const auto& message) {
    msgs::encode(message, bytes);
    writer.append(channel, message.simulated_time / 1000, bytes);
  };
  msgs::Operator wish{};
  msgs::Encoder encoder{};
  msgs::Torque torque{};
  msgs::Sensors sensors{};
  wish.configuration_hash = encoder.configuration_hash = torque.configuration_hash = sensors.configuration_hash = hash;
  wish.run_identity = encoder.run_identity = torque.run_identity = sensors.run_identity = msgs::run_identity(hash);
  // The lever where it stands when the recorder is switched on.
  const std::vector<Request>& requests = run.manoeuvre.requests;
  std::size_t next = 0;
  const std::int64_t whole_cycles = std::llround(settings.from / kBaseStep) / run.cycle_steps;
  const std::int64_t first = whole_cycles * run.cycle_steps;
  for (; next < requests.size() && requests[next].time < static_cast<double>(first) * kBaseStep; ++next) {
    ++wish.sequence;
    wish.speed_request = requests[next].speed_request;
  }
  wish.simulated_time = first * kBaseStepNs;
  append(msgs::kOperatorChannel, wish);
  const auto steps = static_cast<std::int64_t>(run.sensors.size());
  for (std::int64_t n = first; n < steps; ++n) {
    if (n % run.cycle_steps == 0) {
      const std::int64_t cycle = n / run.cycle_steps;
      const auto k = static_cast<std::size_t>(cycle);
      const double now = static_cast<double>(n) * kBaseStep;
      for (; next < requests.size() && requests[next].time <= now + 1e-6 * kBaseStep; ++next) {
        ++wish.sequence;
        wish.simulated_time = n * kBaseStepNs;
        wish.speed_request = requests[next].speed_request;
        append(msgs::kOperatorChannel, wish);
      }
      encoder.sequence = torque.sequence = torque.answered_sequence = cycle;
      encoder.simulated_time = torque.simulated_time = n * kBaseStepNs;
      encoder.operator_sequence = wish.sequence;
      encoder.group_count = torque.group_count = run.group_count;
      encoder.shaft_speed.clear();
      encoder.shaft_position.clear();
      torque.motor_torque.clear();
      for (int i = 0; i < run.group_count; ++i) {
        encoder.shaft_speed.push_back(run.shaft_speed[i][k]);
        encoder.shaft_position.push_back(run.shaft_position[i][k]);
        torque.motor_torque.push_back(run.motor_torque[i][k]);
      }
      torque.alive_counter = cycle + 1;
      torque.enable = run.enable[k];
      torque.brake = run.brake[k];
      append(msgs::kEncoderChannel, encoder);
      append(msgs::kTorqueChannel, torque);
    }
    if (settings.sensors == Sensors::kNone || n % settings.sensor_steps != 0) continue;
    const SensorValues& values = run.sensors[static_cast<std::size_t>(n)];
    sensors.sequence = n / settings.sensor_steps;
    sensors.simulated_time = n * kBaseStepNs;
    for (std::size_t s = 0; s < msgs::kSensorFields<msgs::Sensors>.size(); ++s) {
      const auto& field = msgs::kSensorFields<msgs::Sensors>[s];
      sensors.*field.value = is_recorded(settings.sensors, field.place) ? values.*msgs::kSensorFields<SensorValues>[s].value : kAbsent;
    }
    append(msgs::kSensorsChannel, sensors);
  }
  writer.finish();
}

namespace {

// Base steps of a period [s]; 0 where they are not whole.
std::int64_t whole_steps(double period) {
  const double steps = period / kBaseStep;
  return std::fabs(steps - std::round(steps)) < 1e-6 ? std::llround(steps) : 0;
}

struct Nominal {
  NominalMachine machine;
  sim::DriveProtectionSettings drive_protection;
  std::int64_t hash = 0;
};

Nominal load_nominal(const MakeSettings& settings) {
  const sim::MachineFile crane = sim::load_machine_file(settings.crane);
  if (crane.parameters.boom.element_count == 0) {
    throw std::invalid_argument(fmt::format("{}: it has {}, and withheld cases are made of cranes whose boom bends: 'boom.elements' of 1 or more", settings.crane.string(),
                                            crane.parameters.boom.length > 0.0 ? "a rigid boom" : "no boom"));
  }
  controller::ControllerFile controller = controller::load_controller_file(settings.controller);
  controller.settings.period = settings.controller_period;
  return {nominal_machine(sim::describe(crane), controller.settings), crane.drive_protection,
          msgs::configuration_hash(crane.canonical_text + controller.canonical_text)};
}

json about_text(const MakeSettings& settings, const Nominal& nominal) {
  return {{"cases", settings.cases},
          {"seed", settings.seed},
          {"purpose", name_of(settings.purpose)},
          {"crane", "crane.yaml"},
          {"controller", "controller.yaml"},
          {"controller_period_s", settings.controller_period},
          {"record_period_s", settings.record_period},
          {"sensors", name_of(settings.sensors)},
          {"begin", name_of(settings.begin)},
          {"laws", name_of(settings.laws)},
          {"accelerometer_noise_m_s2", NoiseSettings{}.accelerometer},
          {"configuration_hash", msgs::hash_text(nominal.hash)},
          {"given_to_the_diagnosis", {"crane.yaml", "controller.yaml", "case_*/a.lcmlog", "case_*/b.lcmlog", "case_*/given.json"}}};
}

bool is_complete(const MakeSettings& settings, int number) {
  const fs::path folder = settings.directory / case_name(number);
  return std::all_of(kLogNames.begin(), kLogNames.end(), [&](const char* log) { return fs::exists(folder / log); }) &&
         fs::exists(settings.directory / "sealed" / (case_name(number) + ".json"));
}

RunOptions run_options(std::uint64_t noise_seed) {
  return {.noise_seed = noise_seed, .reference = {.method = sim::ReferenceMethod::kDirk, .tolerance = 1e-5, .order = 3}};
}

bool is_made_of_known_laws(const MakeSettings& settings, const DrawnCase& drawn) { return settings.laws == Laws::kKnown && has_known_laws(drawn); }

// The drawn machine with the laws that are `on`, behind the nominal machine's drive, in one manoeuvre.
TruthRun run_drawn(const MakeSettings& settings, const Nominal& nominal, const DrawnCase& drawn, const std::vector<bool>& on, const Manoeuvre& manoeuvre,
                   std::uint64_t noise_seed) {
  if (is_made_of_known_laws(settings, drawn)) {
    return run_known(known_machine(drawn, nominal.machine, nominal.drive_protection, on), manoeuvre, noise_seed);
  }
  TruthMachine machine = build(drawn, nominal.machine, on);
  machine.drive_protection = nominal.drive_protection;
  return run_truth(machine, manoeuvre, run_options(noise_seed));
}

std::vector<std::vector<TrueSize>> true_sizes(const MakeSettings& settings, const Nominal& nominal, const DrawnCase& drawn) {
  const std::vector<bool> all(drawn.laws.size(), true);
  std::vector<std::vector<TrueSize>> sizes;
  if (is_made_of_known_laws(settings, drawn)) {
    known_machine(drawn, nominal.machine, nominal.drive_protection, all, &sizes);
  } else {
    build(drawn, nominal.machine, all, &sizes);
  }
  return sizes;
}

// What the machine is compared with in the manoeuvres to diagnose: itself without any law, and without each of several.
struct Comparison {
  std::vector<bool> on;
  Visibility seen{};
};

std::vector<Comparison> comparisons_of(std::size_t laws) {
  std::vector<Comparison> comparisons;
  if (laws > 0) comparisons.push_back({std::vector<bool>(laws, false)});
  for (std::size_t k = 0; laws > 1 && k < laws; ++k) {
    comparisons.push_back({std::vector<bool>(laws, true)});
    comparisons.back().on[k] = false;
  }
  return comparisons;
}

json effects_json(const DrawnCase& drawn, const std::vector<std::vector<TrueSize>>& sizes, const std::vector<Comparison>& comparisons) {
  json effects = json::array();
  const std::size_t laws = drawn.laws.size();
  for (std::size_t k = 0; k < laws; ++k) {
    const Law& law = law_named(drawn.laws[k].law);
    json values = json::array();
    for (const TrueSize& size : sizes[k]) {
      values.push_back({{"parameter", size.parameter}, {"value", size.value}, {"comparable", size.comparable}});
    }
    effects.push_back({{"law", law.name}, {"effect", law.effect}, {"subsystem", law.subsystem}, {"follows", law.follows},
                       {"visibility", comparisons[laws == 1 ? 0 : k + 1].seen.largest}, {"sizes", values}});
  }
  return effects;
}

// Throws DriveStopped.
json run_case(const MakeSettings& settings, const Nominal& nominal, const DrawnCase& drawn) {
  const fs::path folder = settings.directory / case_name(drawn.number);
  fs::create_directories(folder);
  std::vector<Comparison> comparisons = comparisons_of(drawn.laws.size());
  for (std::size_t m = 0; m < kLogNames.size(); ++m) {
    const auto run_with = [&](const std::vector<bool>& on) { return run_drawn(settings, nominal, drawn, on, drawn.manoeuvres[m], drawn.noise_seeds[m]); };
    const TruthRun run = run_with(std::vector<bool>(drawn.laws.size(), true));
    write_log(run, {nominal.hash, whole_steps(settings.record_period), settings.sensors, drawn.record_from[m]}, folder / kLogNames[m]);
    if (m >= kDiagnosedManoeuvres) continue;
    for (Comparison& other : comparisons) {
      const Visibility one = visibility(run, run_with(other.on), build(drawn, nominal.machine, other.on), settings.sensors, drawn.record_from[m]);
      if (one.largest > other.seen.largest) other.seen = one;
    }
  }
  const Visibility seen = comparisons.empty() ? Visibility{} : comparisons.front().seen;
  write_whole(folder / "given.json", json{{"without", drawn.without}}.dump() + "\n");
  json spread = json::object();
  for (std::size_t k = 0; k < drawn.spread.size(); ++k) {
    spread[std::string(nominal.machine.description.parameters[k].name)] = drawn.spread[k];
  }
  return {{"case", case_name(drawn.number)},   {"kind", name_of(drawn.kind)},  {"effects", effects_json(drawn, true_sizes(settings, nominal, drawn), comparisons)},
          {"visibility", seen.largest},        {"most_visible", seen.signal},  {"spread", spread}};
}

// With a law too large for the loop, which then does not hold, no machine is in use: it is halved until it does.
json make_case(const MakeSettings& settings, const Nominal& nominal, const DrawnCase& drawn) {
  constexpr int kMostHalvings = 10;
  for (int times = 0;; ++times) {
    try {
      json answer = run_case(settings, nominal, halved(drawn, times));
      answer["halved"] = times;
      return answer;
    } catch (const DriveStopped&) {
      if (times == kMostHalvings) throw;
    }
  }
}

void seal(const MakeSettings& settings) {
  json cases = json::array();
  for (int n = 1; n <= settings.cases; ++n) {
    cases.push_back(json::parse(read_whole(settings.directory / "sealed" / (case_name(n) + ".json"))));
  }
  const std::string text =
      json{{"seed", settings.seed}, {"purpose", name_of(settings.purpose)}, {"cases", cases}}.dump(1) + "\n";
  write_whole(settings.directory / "sealed" / "answers.json", text);
  write_whole(settings.directory / "digest.txt", sha256(text) + "  sealed/answers.json\n");
}

// Throws where the set cannot be made.
Nominal checked_nominal(const MakeSettings& settings) {
  check_seed(settings.seed, settings.purpose);
  if (whole_steps(settings.record_period) < 1 || whole_steps(settings.controller_period) < 1) {
    throw std::invalid_argument("a set's record and controller take a whole number of milliseconds per sample");
  }
  if (settings.cases < 1) throw std::invalid_argument("a set needs at least one case");
  return load_nominal(settings);
}

// A file of the nominal machine as it stands alone: a set goes where the files that it includes are not.
std::string whole_configuration(const fs::path& file) {
  common::InputProblems problems;
  const common::YamlNode root = common::load_yaml_file(file, {}, problems);
  if (!problems.empty()) throw common::InputError(problems);
  return common::yaml_text(root);
}

// Throws where the folder holds another set.
void begin(const MakeSettings& settings, const Nominal& nominal) {
  fs::create_directories(settings.directory / "sealed");
  const std::string about = about_text(settings, nominal).dump(1) + "\n";
  const fs::path about_file = settings.directory / "about.json";
  if (fs::exists(about_file) && read_whole(about_file) != about) {
    throw std::invalid_argument(settings.directory.string() +
                                " holds a set of another seed, size, purpose, crane or laws: take another folder");
  }
  write_whole(settings.directory / "crane.yaml", whole_configuration(settings.crane));
  write_whole(settings.directory / "controller.yaml", whole_configuration(settings.controller));
  write_whole(about_file, about);
}

// Whether the case was not there yet.
bool make(const MakeSettings& settings, const Nominal& nominal, const DrawnCase& drawn) {
  if (is_complete(settings, drawn.number)) return false;
  const std::string name = case_name(drawn.number);
  try {
    write_whole(settings.directory / "sealed" / (name + ".json"), make_case(settings, nominal, drawn).dump(1) + "\n");
  } catch (const std::exception& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
  return true;
}

}  // namespace

void begin_set(const MakeSettings& settings) { begin(settings, checked_nominal(settings)); }

void make_one(const MakeSettings& settings, int number) {
  const Nominal nominal = checked_nominal(settings);
  make(settings, nominal, draw_cases(settings.cases, settings.seed, nominal.machine, settings.begin).at(static_cast<std::size_t>(number - 1)));
}

void seal_set(const MakeSettings& settings) { seal(settings); }

bool make_cases(const MakeSettings& settings, const MakeProgress& progress, const std::function<bool()>& is_stopped) {
  const Nominal nominal = checked_nominal(settings);
  begin(settings, nominal);
  const std::vector<DrawnCase> cases = draw_cases(settings.cases, settings.seed, nominal.machine, settings.begin);
  std::mutex telling;
  int done = 0;
  const auto work = [&](std::size_t n) {
    const bool is_new = make(settings, nominal, cases[n]);
    const std::lock_guard lock(telling);
    ++done;
    if (progress) progress(done, settings.cases, case_name(cases[n].number) + (is_new ? ": written" : ": there already"));
  };
  if (!side_by_side(cases.size(), settings.threads, is_stopped, work)) return false;
  seal(settings);
  return true;
}

MakeSettings settings_of(const fs::path& directory) {
  const json about = json::parse(read_whole(directory / "about.json"));
  MakeSettings settings;
  settings.cases = about.at("cases");
  settings.seed = about.at("seed");
  settings.purpose = about.at("purpose") == name_of(Purpose::kTune) ? Purpose::kTune : Purpose::kScore;
  settings.directory = directory;
  settings.crane = directory / about.at("crane").get<std::string>();
  settings.controller = directory / about.at("controller").get<std::string>();
  settings.controller_period = about.at("controller_period_s");
  settings.record_period = about.at("record_period_s");
  settings.sensors = sensors_named(about.at("sensors"));
  settings.begin = begin_named(about.at("begin"));
  settings.laws = laws_named(about.value("laws", name_of(Laws::kWithheld)));
  return settings;
}

void measure_again(const MakeSettings& settings, int number, const Manoeuvre& in_ramps, const std::string& purpose, const fs::path& log) {
  const Nominal nominal = load_nominal(settings);
  const json sealed = json::parse(read_whole(settings.directory / "sealed" / (case_name(number) + ".json")));
  const DrawnCase drawn = halved(draw_cases(settings.cases, settings.seed, nominal.machine, settings.begin).at(static_cast<std::size_t>(number - 1)),
                                 sealed.at("halved"));
  const double ramp = nominal.machine.controller.ramp.acceleration_time;
  Manoeuvre manoeuvre = in_ramps;
  manoeuvre.duration *= ramp;
  for (Request& request : manoeuvre.requests) request.time *= ramp;
  Random noise(settings.seed, "again: " + purpose, static_cast<std::uint64_t>(number));
  const TruthRun run = run_drawn(settings, nominal, drawn, std::vector<bool>(drawn.laws.size(), true), manoeuvre, noise.bits());
  write_log(run, {nominal.hash, whole_steps(settings.record_period), settings.sensors, 0.0}, log);
}

}  // namespace slewlab::diagnosis::withheld
