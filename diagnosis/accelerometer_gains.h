// Accelerometers that read too much or too little. A gain stands in the machine's file as 1 where nobody has calibrated it (`sensors:`), and is no parameter of
// every fit. But an accelerometer that reads 4 % too much does what encoders do that count 4 % too little, and by few sensors what other effects do. So parameters alone, and where an effect
// beside them leaves more than noise, or wants parameters of another make, that fit too, are fitted once more with the gains of all accelerometers that were read free beside them, each a parameter as likely within its spread as others within theirs
// (sim::kAccelerometerDeviation), from where they stand without and from where the file has the parameters, which a gain may have moved far; and the better fit is weighed against another one by what evidence.h weighs by, without what an effect costs for being one and for its size,
//
//   odds = exp(-(E_gains - E_other) / 2 T),   E = residual power + p of the parameters + sum(ln(1 + s lambda)).
//
// Where it leaves noise alone and is likelier than all that have one law more than it at most, surely, the records are those of a machine with such accelerometers, and are diagnosed on that; where it is about as likely as a cause, that is not sure (doubt.h).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/evidence.h"
#include "diagnosis/fit.h"
#include "diagnosis/problem.h"
#include "sim/machine/description.h"

namespace slewlab::diagnosis {

struct AccelerometerGain {
  std::string name;        // "tip accelerometer gain"
  sim::FileNumber number;  // of the machine's file
  double gain = 1.0;       // as fitted, times what the file has
  double deviation = 0.0;  // standard deviation that the records leave open
};

struct GainsFit {
  FitResult fit;  // its point has the gains behind the parameters
  std::vector<AccelerometerGain> gains;
};

// From where parameters alone, or an effect with them, have ended. Nothing where no accelerometer was read. Throws Interrupted.
std::optional<GainsFit> fit_gains(Problem& problem, const FitResult& without);

// odds / (1 + odds) of the gains against another fit on the problem's machine.
double chance_of_gains(const Problem& problem, const GainsFit& gains, const FitResult& other, const EvidenceSettings& settings);

// Whether they leave noise alone, beside parameters that machines of one make have, and are likelier than each of the others, surely.
bool are_the_answer(const Problem& problem, const GainsFit& gains, std::span<const FitResult* const> others, const EvidenceSettings& settings);

// The machine with such accelerometers.
sim::CraneParameters with_gains(sim::CraneParameters machine, const std::vector<AccelerometerGain>& gains);

// Those farther from 1 than the records leave open: "tip accelerometer gain 1.041 (+-0.003)".
std::string in_words(const std::vector<AccelerometerGain>& gains);

}  // namespace slewlab::diagnosis
