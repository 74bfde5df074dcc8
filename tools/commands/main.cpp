// slewlab: the command. Every subcommand is a file of its own in this folder; here is only the list of them.

#include <CLI/CLI.hpp>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <utility>

#include "tools/commands/accept_command.h"
#include "tools/commands/check_command.h"
#include "tools/commands/command_line.h"
#include "tools/commands/command_pages.h"
#include "tools/commands/cut_command.h"
#include "tools/commands/diagnose_command.h"
#include "tools/commands/export_fmu_command.h"
#include "tools/commands/home.h"
#include "tools/commands/modes_command.h"
#include "tools/commands/new_command.h"
#include "tools/commands/option_check.h"
#include "tools/commands/output_folder.h"
#include "tools/commands/python_command.h"
#include "tools/commands/replay_command.h"
#include "tools/commands/schema.h"
#include "tools/commands/simulate_command.h"
#include "tools/commands/soak_command.h"
#include "tools/commands/verify_command.h"
#include "tools/commands/version.h"
#include "tools/commands/whole_file.h"
#include "tools/commands/withhold_command.h"

namespace slewlab::tools {
namespace {

// What an option means that was not given: a file of slewlab's own.
void fill(std::filesystem::path& file, const char* own) {
  if (file.empty()) file = home() / own;
}

// Each of these adds its subcommand; what it is to do goes into `action`.

void add_check(CLI::App& app, Action& action) {
  struct Options {
    std::vector<std::filesystem::path> files;
    std::vector<std::string> overrides;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("check", "Read files of every kind (slewlab schema has them) and say what is wrong");
  command->add_option("FILE", options->files, "files to check")->required()->check(readable_file());
  add_settings(*command, options->overrides, "key=value over every file");
  command->callback([options, &action] {
    action = [options] {
      // An import map is read by the import's own reader.
      std::vector<std::filesystem::path> files;
      std::vector<std::string> maps;
      for (const std::filesystem::path& file : options->files) {
        if (kind_in(file) == "import_map") {
          maps.push_back(file.string());
        } else {
          files.push_back(file);
        }
      }
      const int code = check_files(files, parse_overrides(options->overrides), std::cout, std::cerr);
      std::cout.flush();
      return maps.empty() ? code : std::max(code, call_python("check_map.py", maps));
    };
  });
}

void add_run(CLI::App& app, const std::vector<std::string>& command_line, Action& action) {
  add_run_options(*app.add_subcommand("run", "Run a scenario: plant and controller as two processes over LCM"), command_line, action);
}

void add_replay(CLI::App& app, const std::vector<std::string>& command_line, Action& action) {
  struct Options {
    ReplayOptions replay;
    std::vector<std::string> overrides;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("replay", "Feed a log to plant and controller again and compare to the bit");
  command->add_option("LOG", options->replay.log, "log, or the folder of a run")->required()->check(readable_path());
  command->add_option("--scenario", options->replay.scenario, "in place of scenario.yaml beside the log");
  command->add_option("--crane,--axis", options->replay.crane, "in place of the scenario's machine");
  command->add_option("--controller-config", options->replay.controller_config, "in place of the scenario's");
  CLI::Option* own = command->add_option("--controller", options->replay.controller_command,
                                         "shell command of your own controller: what it would have answered to the recorded motion")
                         ->check(shell_command());
  command->add_option("--controller-fmu", options->replay.controller_fmu, "the same of a controller that is an FMU (docs/fmu.md)")
      ->check(readable_file())
      ->excludes(own);
  command->add_option("--tolerance", options->replay.tolerances,
                      "CHANNEL.FIELD=SIZE: differences up to this size do not count, e.g. TORQUE.motor_torque=0.5");
  command->add_option("--run", options->replay.run, "which of several runs in the log, from 1 (all)")
      ->check(whole_number(1));
  add_settings(*command, options->overrides, "key=value, as of slewlab run");
  command->callback([options, &command_line, &action] {
    action = [options, &command_line] {
      options->replay.overrides = parse_overrides(options->overrides);
      return replay(options->replay, command_line, std::cout, std::cerr);
    };
  });
}

void add_simulate(CLI::App& app, Action& action) {
  struct Options {
    SimulateOptions simulate;
    std::vector<std::string> overrides;
    double longest_step_ms = 1.0;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("simulate", "Drive a machine by the torque of a log, open loop, for report against the log");
  command->add_option("MACHINE", options->simulate.machine, "file of a crane or an axis")->required()->check(readable_file());
  command->add_option("LOG", options->simulate.log, "log, or the folder of a run")->required()->check(readable_path());
  command->add_option("--out", options->simulate.out, "folder for the simulated log")->required();
  command->add_option("--plant-step", options->longest_step_ms, "[ms] longest step of the plant (1)")->check(positive_number());
  add_settings(*command, options->overrides, "key=value over the machine's file");
  command->callback([options, &action] {
    action = [options] {
      constexpr double kMillisecond = 1e-3;  // [s]
      options->simulate.longest_step = options->longest_step_ms * kMillisecond;
      options->simulate.overrides = parse_overrides(options->overrides);
      return simulate(options->simulate, std::cout);
    };
  });
}

void add_cut(CLI::App& app, Action& action) {
  auto options = std::make_shared<CutOptions>();
  CLI::App* command = app.add_subcommand("cut", "A piece of a log as a log: what lies before or behind a gap, a trip, a change");
  command->add_option("LOG", options->log, "log, or the folder of a run")->required()->check(readable_path());
  command->add_option("--out", options->out, "name of the piece")->required();
  command->add_option("--from", options->from, "[s] of the run, where the piece begins (the run's begin)");
  command->add_option("--until", options->until, "[s] of the run, where the piece ends (the run's end)");
  command->add_option("--run", options->run, "which of several runs in the log, from 1")->check(whole_number(1));
  command->callback([options, &action] { action = [options] { return cut(*options, std::cout); }; });
}

void add_accept(CLI::App& app, const std::vector<std::string>& command_line, Action& action) {
  struct Options {
    AcceptOptions accept;
    std::vector<std::string> overrides;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("accept", "Check a controller's run against limits: pass or fail, and why");
  CLI::Option* subject = command->add_option("SCENARIO|RUN_DIR", options->accept.subject, "scenario to run, or a run that was made already")
                             ->check(readable_path());
  auto plan = std::make_shared<std::filesystem::path>();
  CLI::Option* record = command->add_option("--record", *plan, "test plan: make every run of it, and the record that traces requirements to them")
                            ->check(readable_file())
                            ->excludes(subject);
  CLI::Option* own = command->add_option("--controller", options->accept.controller_command, "shell command of your own controller")->check(shell_command());
  command->add_option("--controller-fmu", options->accept.controller_fmu, "controller that is an FMU (docs/fmu.md)")
      ->check(readable_file())
      ->excludes(own);
  command->add_option("--plant", options->accept.plant_command, "shell command of your own plant")->check(shell_command());
  command->add_option("--limits", options->accept.limits, "limits (config/acceptance/thesis.yaml)")->excludes(record);
  command->add_flag_callback("--no-plot", [options] { options->accept.plot = false; }, "no acceptance.html");
  command->add_option("--junit", options->accept.junit, "JUnit XML to write, for CI");
  command->add_option("--out", options->accept.out, "folder for the run (runs/accept_<scenario>), or for the record (runs/record_<plan>)");
  add_settings(*command, options->overrides, "key=value, as of slewlab run")->excludes(record);
  command->callback([options, plan, subject, record, &command_line, &action] {
    if (subject->count() + record->count() == 0) throw CLI::RequiredError("SCENARIO|RUN_DIR or --record");
    if (record->count() > 0) {
      options->accept.record = true;
      options->accept.subject = *plan;
    }
    action = [options, &command_line] {
      fill(options->accept.limits, "config/acceptance/thesis.yaml");
      options->accept.overrides = parse_overrides(options->overrides);
      return accept(options->accept, command_line);
    };
  });
}

void add_diagnose(CLI::App& app, Action& action) {
  auto options = std::make_shared<DiagnoseOptions>();
  CLI::App* command = app.add_subcommand("diagnose", "Where a measured crane differs from its model, and which effect causes it");
  command->add_option("--crane,--axis", options->crane, "nominal machine")->required();
  command->add_option("--controller", options->controller,
                      "nominal controller; without it the machine's side alone is judged");
  command->add_option("--log", options->logs, "measured logs, or folders of runs; more than one manoeuvre tells more")->required();
  command->add_option("--unseen", options->unseen, "logs that the answer is tried on and that have no part in it");
  command->add_option("--out", options->out, "folder for the findings")->required();
  command->add_option("--without", options->without, "effects that the catalogue is to do without; of an axis: laws of its torque balance");
  command->add_flag("--measured-torque", options->is_torque_measured, "the logs' torques were measured, not commanded: their scatter is noise; not of an axis");
  command->add_option("--fitted-seconds", options->fitted_seconds, "[s] of all logs that are fitted at most (four minutes of the thesis crane); of longer ones where most moves")->check(positive_number());
  command->add_option("--threads", options->threads, "simulations side by side (2); not of an axis")->check(whole_number(1));
  command->callback([options, &action] {
    options->terminal = ::isatty(STDERR_FILENO) == 1;
    action = [options] { return diagnose_logs(*options, std::cout, std::cerr); };
  });
}

void add_withhold_score(CLI::App& withhold, Action& action);

void add_withhold(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("withhold", "Machines nobody has looked at, to judge the diagnosis by");
  command->require_subcommand(1);
  auto options = std::make_shared<WithholdMakeOptions>();
  CLI::App* make = command->add_subcommand("make", "Draw machines, run them and write their logs; answers sealed");
  make->add_option("--cases", options->cases, "how many")->required()->check(whole_number(1));
  make->add_option("--seed", options->seed, "below 1000 for tuning, from 1000 on for scoring")->required()->check(whole_number(0));
  make->add_option("--out", options->directory, "folder for the set")->required();
  make->add_option("--purpose", options->purpose, "tune or score: refused where the seed is for the other");
  make->add_option("--crane", options->crane, "nominal crane (config/cranes/thesis.yaml)");
  make->add_option("--controller", options->controller, "nominal controller (config/controllers/thesis.yaml)");
  make->add_option("--rate", options->rate, "[Hz] of the record: SENSORS, and the controller with ENCODER and TORQUE (1000); a whole number of milliseconds per sample")->check(positive_number());
  make->add_option("--sensors", options->sensors, "all, tip or none: what is recorded beside encoders and torques")->check(one_of({"all", "tip", "none"}));
  make->add_option("--begin", options->begin, "rest, on, motion or any: when the recorder is switched on; with the drives on, under way, each of the three, drawn at random")->check(one_of({"rest", "on", "motion", "any"}));
  make->add_option("--laws", options->laws, "withheld, which the diagnosis does not have, or known, its own, for what can be reached at best (withheld)")->check(one_of({"withheld", "known"}));
  make->add_option("--controller-period", options->controller_period_ms, "[ms] whole milliseconds (as --rate has it)")->check(whole_number(1));
  make->add_option("--threads", options->threads, "cases side by side")->check(whole_number(1));
  make->callback([options, &action] {
    action = [options] {
      fill(options->crane, "config/cranes/thesis.yaml");
      fill(options->controller, "config/controllers/thesis.yaml");
      return withhold_make(*options, std::cout, std::cerr);
    };
  });
  add_withhold_score(*command, action);
}

void add_withhold_score(CLI::App& withhold, Action& action) {
  auto options = std::make_shared<WithholdScoreOptions>();
  CLI::App* score = withhold.add_subcommand("score", "Diagnose every case of a set, then open its answers");
  score->add_option("DIR", options->directory, "the set")->required();
  score->add_option("--results", options->results, "folder in it for the results");
  score->add_flag("--no-accelerometers", options->no_accelerometers, "encoders and torques alone");
  score->add_option("--threads", options->threads, "cases side by side")->check(whole_number(1));
  score->add_option("--from", options->from, "the case to begin with (1)")->check(whole_number(1));
  score->add_option("--first", options->first, "only so many cases, from there on")->check(whole_number(1));
  score->add_flag("--second-round", options->second_round, "where an answer is not sure, the machine drives the manoeuvre that it proposes, and one that is drawn, and is diagnosed again");
  score->add_flag("--no-informed-fits", options->no_informed_fits, "no fits that are told the effects: the share of the gap closed is of those there already");
  score->callback([options, &action] {
    action = [options] { return withhold_judge(*options, std::cout, std::cerr); };
  });
}

void add_soak(CLI::App& app, Action& action) {
  struct Options {
    SoakOptions soak;
    std::vector<std::string> overrides;
  };
  auto options = std::make_shared<Options>();
  SoakOptions& soak_options = options->soak;
  CLI::App* command = app.add_subcommand("soak", "Slew at random for hours, faster than real time, and check what must always hold");
  auto* hours = command->add_option("--hours", soak_options.hours, "simulated hours, rounded up to whole tasks")
                    ->check(positive_number());
  command->add_option("--seed", soak_options.seed, "of everything drawn")->required()->check(whole_number(0));
  auto* jobs = command->add_option("--jobs", soak_options.jobs, "worker processes (1)")->check(whole_number(1, 1024));
  command->add_flag("--faults", soak_options.faults, "draw faults as well (docs/faults.md)");
  auto* task = command->add_option("--task", soak_options.task,
                                   "instead of hours: run task K, or K-L one after the other, and keep the logs");
  hours->excludes(task);
  jobs->excludes(task);
  command->add_option("--out", soak_options.out,
                      "folder for journal and failures (soak-SEED); the same command goes on where it was stopped");
  command->add_option("--crane", soak_options.crane, "crane (config/cranes/thesis.yaml)")->check(readable_file());
  command->add_option("--controller", soak_options.controller, "controller (config/controllers/thesis.yaml)")
      ->check(readable_file());
  command->add_option("--config", soak_options.config, "what is drawn, and the limits (config/soak/thesis.yaml)")
      ->check(readable_file());
  add_settings(*command, options->overrides, "key=value: of --config as they are, crane.KEY and controller.KEY, e.g. limits.sidelead=5deg");
  command->footer("Journal, failures and how to repeat one: docs/soak.md");
  command->callback([options, hours, task, &action] {
    if (hours->count() + task->count() == 0) throw CLI::RequiredError("--hours or --task");
    action = [options] {
      fill(options->soak.crane, "config/cranes/thesis.yaml");
      fill(options->soak.controller, "config/controllers/thesis.yaml");
      fill(options->soak.config, "config/soak/thesis.yaml");
      options->soak.overrides = parse_overrides(options->overrides);
      return soak(options->soak);
    };
  });
}

// What Python does: its options are the Python program's own, and so is its help.
void add_python(CLI::App& app, const char* name, const char* script, const char* description, Action& action) {
  CLI::App* command = app.add_subcommand(name, description);
  command->prefix_command();
  command->set_help_flag();
  command->callback([command, script, &action] {
    action = [command, script] { return run_python(script, command->remaining()); };
  });
}

// To viewers, or to a PLC: a program each.
void add_bridge(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("bridge", "A run's messages for viewers (--foxglove), or a PLC as the controller (modbus, opcua, ads)");
  command->prefix_command();
  command->set_help_flag();
  command->callback([command, &action] {
    action = [command] {
      const std::vector<std::string> words = command->remaining();
      const bool is_plc = !words.empty() && (words[0] == "modbus" || words[0] == "opcua" || words[0] == "ads" ||
                                               std::find(words.begin(), words.end(), "--map") != words.end());
      return run_python(is_plc ? "plc_bridge.py" : "bridge.py", words);
    };
  });
}

void add_modes(CLI::App& app, Action& action) {
  struct Options {
    ModesOptions modes;
    std::vector<std::string> overrides;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("modes", "Eigenfrequencies, convergence and frequency response of a crane or an axis");
  command->add_option("MACHINE", options->modes.crane, "file of a crane or an axis")->required();
  command->add_option("--elements", options->modes.elements, "boom elements, in place of the crane's own")
      ->check(whole_number(0, 256));
  command->add_option("--bode", options->modes.bode, "CSV of the response from motor torque to tip velocity");
  add_settings(*command, options->overrides, "key=value over the machine's file");
  command->callback([options, &action] {
    action = [options] {
      options->modes.overrides = parse_overrides(options->overrides);
      return show_modes(options->modes, std::cout);
    };
  });
}

void add_export_fmu(CLI::App& app, Action& action) {
  struct Options {
    ExportFmuOptions fmu;
    std::vector<std::string> overrides;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("export-fmu", "A machine as plant, or a controller, as an FMU for co-simulation");
  command->add_option("FILE", options->fmu.file, "file of a crane, an axis or a controller")->required();
  command->add_option("--fmi", options->fmu.fmi, "version of the standard: 2 (2.0) or 3 (3.0)")->check(one_of({"2", "3"}));
  command->add_option("--out", options->fmu.out, "FMU to write (FILE's name with .fmu, where one stands)");
  command->add_option("--period", options->fmu.period_ms, "[ms] communication step (10); a controller takes no other")->check(positive_number());
  CLI::Option* step = command->add_option("--plant-step", options->fmu.plant_step_ms, "[ms] of the plant's integration (1)")->check(positive_number());
  CLI::Option* seed = command->add_option("--seed", options->fmu.seed, "of the plant's effects that draw numbers (0)")->check(whole_number(0));
  add_settings(*command, options->overrides, "key=value over the file");
  command->callback([options, step, seed, &action] {
    for (const CLI::Option* given : {seed, step}) {
      if (given->count() > 0) options->fmu.of_a_plant = given->get_name();
    }
    action = [options] {
      options->fmu.overrides = parse_overrides(options->overrides);
      return export_fmu(options->fmu, std::cout);
    };
  });
}

void add_verify(CLI::App& app, Action& action) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command = app.add_subcommand("verify", "Compute every number of the thesis anew and compare");
  command->add_option("--config", options->config_directory, "folder with cranes/ and controllers/")
      ->check(readable_folder());
  command->add_flag("--json", options->json, "rows as JSON");
  command->callback([options, &action] {
    action = [options] {
      fill(options->config_directory, "config");
      return verify(*options, std::cout, std::cerr);
    };
  });
}

// Of the commands that Python reads; the build writes them.
ForeignOptions foreign_options() { return read_foreign_options(python_messages() / "commands.json"); }

void add_completion(CLI::App& app, Action& action) {
  auto out = std::make_shared<std::filesystem::path>();
  CLI::App* command = app.add_subcommand("completion", "Completion for bash (and zsh): source <(slewlab completion)");
  command->add_option("--out", *out, "file to write, in place of the standard output");
  command->callback([out, &app, &action] {
    action = [out, &app] {
      make_folder_of(*out);
      const std::string script = completion_script(app, foreign_options(), {{"--without", names_left_out()}});
      if (out->empty()) {
        std::cout << script;
      } else {
        write_whole_file(*out, script);
      }
      return 0;
    };
  });
}

// For packagers; a person reads --help.
void add_manual(CLI::App& app, Action& action) {
  struct Options {
    std::filesystem::path out;
    std::vector<std::filesystem::path> helps;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("manual", "Write the manual pages")->group("");
  command->add_option("--out", options->out, "folder for the pages")->required();
  command->add_option("--help-of", options->helps, "PROGRAM.txt: what the program of that name says at --help")->check(readable_file());
  command->callback([options, &app, &action] {
    action = [options, &app] {
      make_output_folder(options->out);
      std::vector<CommandPage> pages = manual_pages(app, version(), foreign_options());
      for (const std::filesystem::path& help : options->helps) {
        std::ifstream file(help);
        pages.push_back(page_of_help(help.stem().string(), std::string(std::istreambuf_iterator<char>(file), {}), version()));
      }
      for (const CommandPage& page : pages) write_whole_file(options->out / page.name, page.text);
      return 0;
    };
  });
}

constexpr const char* kExitCodes =
    "Exit codes: 0 done, and what was checked is as it should be; 1 it is not, or the work failed; 2 the command line or "
    "a file that it names is wrong, and nothing was begun; 3 the records given to diagnose cannot tell; 128 + N ended by signal N.";

// What of a new file is told already, for the program that asks for the rest.
std::vector<std::string> words_of(const NewOptions& file, const std::string& data) {
  std::vector<std::string> words;
  for (const std::string& word : {file.kind, file.file.string()}) {
    if (!word.empty()) words.push_back(word);
  }
  for (const auto& [name, value] : {std::pair{"--crane", file.machine.string()}, {"--controller", file.controller.string()}, {"--data", data}}) {
    if (!value.empty()) words.insert(words.end(), {name, value});
  }
  return words;
}

void add_new(CLI::App& app, Action& action) {
  struct Options {
    NewOptions file;
    std::string data;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("new", "Write a commented file to begin with");
  command->add_option("KIND", options->file.kind, "crane, axis, controller, scenario or map; asked for on a terminal")->check(one_of({"crane", "axis", "controller", "scenario", "map"}));
  command->add_option("FILE", options->file.file, "to be written, never over one that is there; asked for on a terminal, and of a machine its main numbers");
  command->add_option("--crane,--axis", options->file.machine, "machine of a controller or a scenario");
  command->add_option("--controller", options->file.controller, "controller of a scenario");
  command->add_option("--data", options->data, "data of a map: CSV or Parquet, from whose header columns, units and signs are guessed");
  command->callback([options, &action] {
    const bool asks = (options->file.file.empty() || (options->file.kind == "map" && options->data.empty())) && ::isatty(STDIN_FILENO) == 1 &&
                      ::isatty(STDOUT_FILENO) == 1;
    if (asks) {
      action = [options] { return run_python("new_questions.py", words_of(options->file, options->data)); };
      return;
    }
    if (options->file.kind.empty()) throw CLI::RequiredError("KIND");
    if (options->file.file.empty()) throw CLI::RequiredError("FILE");
    action = [options] {
      const bool is_map = options->file.kind == "map";
      if (is_map && !(options->file.machine.empty() && options->file.controller.empty())) {
        throw common::InputError({{{"--crane, --controller", 0, 0}, "", "a machine or a controller beside a new map", "--data alone"}});
      }
      if (is_map && options->data.empty()) throw common::InputError({{{"--data", 0, 0}, "", "nothing", "the table that the map is for"}});
      if (is_map) return run_python("new_map.py", {options->file.file.string(), "--data", options->data});
      if (!options->data.empty()) throw common::InputError({{{"--data", 0, 0}, "", "data beside a new " + options->file.kind, "them beside a map"}});
      options->file.templates = home() / "config" / "templates";
      return write_new(options->file, std::cout);
    };
  });
}

void add_schema(CLI::App& app, Action& action) {
  struct Options {
    std::string kind;
    std::filesystem::path out;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("schema", "JSON Schema of a kind of file, for completion and marks in an editor");
  CLI::Option* kind = command->add_option("KIND", options->kind, "crane, axis, controller, scenario, acceptance, acceptance_plan, campaign, soak, plc_map or import_map");
  std::vector<std::string> kinds = schema_kinds();
  kinds.emplace_back("import_map");  // of which the import's own reader tells
  kind->check(one_of(kinds));
  CLI::Option* out = command->add_option("--out", options->out, "folder for KIND.schema.json of every kind");
  kind->excludes(out);
  command->callback([options, kind, out, &action] {
    if (kind->count() + out->count() == 0) throw CLI::RequiredError("KIND or --out");
    action = [options] {
      const std::string of_maps = "map_schema.py";  // a map's reader is the import's
      if (options->kind == "import_map") return run_python(of_maps, {});
      if (options->out.empty()) {
        std::cout << schema_of(options->kind).dump(2) << std::endl;
        return 0;
      }
      make_output_folder(options->out);
      for (const std::string& each : schema_kinds()) {
        write_whole_file(options->out / (each + ".schema.json"), schema_of(each).dump(2) + "\n");
      }
      return run_python(of_maps, {(options->out / "import_map.schema.json").string()});
    };
  });
}

int main(const std::vector<std::string>& command_line) {
  CLI::App app{"slewlab: a simulated crane slewing drive, and what to do with it", "slewlab"};
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text(), "versions of slewlab, LCM and SUNDIALS");
  app.footer(kExitCodes);
  Action action;
  add_run(app, command_line, action);
  add_replay(app, command_line, action);
  add_simulate(app, action);
  add_cut(app, action);
  add_accept(app, command_line, action);
  add_soak(app, action);
  add_check(app, action);
  add_modes(app, action);
  add_export_fmu(app, action);
  add_verify(app, action);
  add_diagnose(app, action);
  add_withhold(app, action);
  add_new(app, action);
  add_schema(app, action);
  add_completion(app, action);
  add_manual(app, action);
  add_python(app, "report", "report.py", "Draw a run: a page with pictures and numbers beside its log", action);
  add_python(app, "campaign", "campaign_command.py", "Run a study: scenarios over a grid or a draw of values, one table of results", action);
  add_python(app, "desk", "desk_command.py", "Watch, steer and scrub: a page of a running scenario or a log", action);
  add_bridge(app, action);
  add_python(app, "soft-plc", "soft_plc.py", "A PLC on loopback to try a map of registers, nodes or symbols with", action);
  add_python(app, "export", "export.py", "Turn a log into Parquet, CSV or MCAP files", action);
  add_python(app, "import", "import_data.py", "Turn measured CSV or Parquet into a log, by a map of its columns", action);
  return act(app, command_line, action);
}

}  // namespace
}  // namespace slewlab::tools

int main(int argc, char** argv) { return slewlab::tools::main({argv, argv + argc}); }
