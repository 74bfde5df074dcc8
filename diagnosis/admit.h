// From records to the problem that every fit works on: what cannot be judged is refused, the rest gets the observer's gains and the
// whitening of its differences.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/validate.h"

namespace slewlab::diagnosis {

inline constexpr double kLeastTrusted = 0.3;  // share of a record that must lie away from impacts

// Whether some record's encoders count so coarsely that their noise rules the torques.
bool has_coarse_counts(std::span<const Record> records);

// How differences are whitened behind the thresholds: where counts are coarse mesh and step miss more, because the controller's steps
// shake the high modes.
WhiteningSettings whitening_for(const Thresholds& thresholds, bool is_coarse);

// Sets nominal machine, thresholds, nuisances and gains. Throws std::invalid_argument where the machine cannot be described.
void set_machine(const sim::MachineSettings& nominal, const std::vector<Record>& records, Problem& problem);

// How a record is whitened that the nominal machine follows so, judged between two grid points alone.
Whitening whitening_between(const Problem& problem, const Record& record, const Shadow& nominal, const WhiteningSettings& settings, std::size_t from, std::size_t to);

// Takes the records into the problem, each with its whitening. Those of which too little lies away from impacts are left out, and
// remarked. Gives the last one that is judged, as the nominal machine follows it. Throws NotAdmitted.
Followed admit(std::vector<Record> records, const WhiteningSettings& whitening, Problem& problem, std::vector<std::string>& remarks);

RecordBegins begin_of(const Record& record);

// The share of a record that would be judged: that lies away from impacts as the nominal machine follows it. Throws NotAdmitted where the record is refused for another reason.
double judged_share(const sim::MachineSettings& nominal, Record record);

// The whitening of the admitted records by other settings, on the nominal machine that they were admitted with.
void whiten_again(Problem& problem, const WhiteningSettings& whitening);

}  // namespace slewlab::diagnosis
