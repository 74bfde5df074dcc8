#pragma once

// A soak's campaign: tasks 0 ... count-1, shared out to worker processes, with a journal of one line per task done.
// Whoever is stopped - by Ctrl-C, by kill -9, by a power cut - goes on where the journal ends. A worker that dies takes
// only its task with it: that is a failure like any other, and a new worker goes on.
//
//   OUT/journal.jsonl            a head that says which campaign this is, then one JSON object per task, as they end
//   OUT/failures/task-000012/    of every failed task: run.lcmlog, scenario.yaml, crane.yaml, controller.yaml (slewlab run
//                                and replay take them) and failure.txt: what broke, when, and the command that repeats it
//   OUT/summary.json             the last session's numbers
//
// The journal holds nothing that depends on the machine: sorted, it is the same for any number of workers and
// interruptions.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/soak/task_run.h"

namespace slewlab::tools {

struct CampaignSettings {
  SoakPlan plan;
  std::int64_t task_count = 0;
  int jobs = 1;
  std::filesystem::path out;
  std::string command;  // that repeats a task, up to the number behind --task
};

struct CampaignProgress {
  std::int64_t tasks = 0;           // of the campaign
  std::int64_t done = 0;            // in the journal
  std::int64_t failed = 0;          // of those
  std::int64_t done_here = 0;       // in this session
  double task_seconds = 0.0;        // simulated, of one task
  double wall_seconds = 0.0;        // of this session
};

struct CampaignHooks {
  std::function<bool()> stop;
  std::function<void(const CampaignProgress&)> progress;      // at least once a second
  std::function<void(const std::string&)> failure;            // text of failure.txt
  std::function<void(std::int64_t number)> in_worker;         // before each task, in the worker's process: for tests
};

struct CampaignReport {
  bool complete = false;  // all tasks are in the journal
  CampaignProgress progress;
  std::vector<std::int64_t> failed_tasks;
  double largest_energy_error = 0.0;  // [-]
  double largest_house_speed = 0.0;   // [rad/s]
  double largest_sidelead = 0.0;      // [rad]
  std::int64_t trips = 0;
  std::int64_t play_crossings = 0;
};

// Throws std::runtime_error: the folder holds another campaign or another process writes into it, the disk is full;
// common::InputError: a file of the configuration is wrong.
CampaignReport run_campaign(const CampaignSettings& settings, const CampaignHooks& hooks);

// Memory over a worker's life: from its fifth task on nothing may grow.
class WorkerMemory {
 public:
  // After a task; adds a violation to the result where memory grew.
  void look(const SoakLimits& limits, TaskResult& result);
  std::int64_t first_task() const { return first_task_; }

 private:
  std::int64_t tasks_ = 0;
  std::int64_t first_task_ = 0;
  MemoryUse warm_;
};

std::string journal_line(const TaskResult& result);
// What a failed task leaves for people, with the command that repeats it.
std::string failure_text(const TaskResult& result, const SoakPlan& plan, const std::string& command);

}  // namespace slewlab::tools
