// Logs as a diagnosis takes them: admitted on the nominal machine. Throws NotAdmitted.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/admit.h"
#include "sim/effects/catalogue.h"
#include "tests/diagnosis/bench.h"

namespace slewlab::diagnosis {

struct Admitted {
  explicit Admitted(const std::vector<msgs::RunLog>& logs, const sim::CraneParameters& crane = bench().crane) {
    const AdmissionSettings of_records = thresholds_of(sim::describe(crane)).admission;
    std::vector<Record> records;
    for (const msgs::RunLog& log : logs) records.push_back(make_record(log, std::string(1, static_cast<char>('a' + records.size())), of_records));
    sim::MachineSettings nominal;
    nominal.crane = crane;
    problem.threads = 2;
    set_machine(nominal, records, problem);
    whitening = whitening_for(problem.thresholds, false);
    admit(std::move(records), whitening, problem, remarks);
  }

  Point at(std::vector<common::EffectInstance> effects) const { return {std::vector<double>(nuisance_count(problem), 0.0), std::move(effects), 0}; }

  Problem problem;
  WhiteningSettings whitening;
  std::vector<std::string> remarks;
};

// What a diagnosis leaves out that is to look for these alone.
inline std::vector<std::string> all_but(const common::EffectCatalogue& catalogue, std::span<const std::string_view> kept) {
  std::vector<std::string> names;
  for (const common::EffectAbout& about : catalogue.effects) {
    if (std::find(kept.begin(), kept.end(), about.name) == kept.end()) names.emplace_back(about.name);
  }
  return names;
}

}  // namespace slewlab::diagnosis
