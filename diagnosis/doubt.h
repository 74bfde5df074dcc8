// What the evidence cannot know of the causes that it weighed (evidence.h): each of these takes probability from a cause, and says where it goes.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "common/effect.h"
#include "diagnosis/evidence.h"
#include "diagnosis/hidden_effects.h"
#include "diagnosis/nuisance.h"
#include "diagnosis/problem.h"
#include "diagnosis/ranking.h"
#include "diagnosis/screen.h"
#include "diagnosis/where.h"

namespace slewlab::diagnosis {

inline constexpr double kDoubtTakes = 0.4;  // share of its probability that a doubted cause loses: it still leads, and is not sure
inline constexpr double kFarOff = 2.6;  // [standard deviations] of a parameter, beyond which it may be another crane

// Whether with this cause a parameter, or all parameters together, are farther off than machines of one make differ.
bool is_of_another_make(const Nuisances& nuisances, const Cause& cause);
// Of what is "unknown", by how often it was on machines that no score uses; the rest are known effects whose law is another one than the catalogue's.
inline constexpr double kOutsideTheCatalogue = 0.7;

// The residual of the nominal machine is no more than noise: what fits the records better fits noise.
void settle_on_nothing(Ranking& ranking);

// The residual of parameters alone is no more than noise. That some machine would have a smaller one still says little of a cause that nobody knows:
// at most it is as likely as not. A law that was fitted does say something, as far as it is none of the catalogue's: `unknown_law` is its
// probability.
void doubt_the_unknown_below_the_noise(double unknown_law, Ranking& ranking);

// An effect that was fitted to the end of its range is no sure answer: a larger one would fit better. Nor is one whose interval goes beyond its
// range, or that the records do not tell from where the effect is absent: they do not say that it is there. Nor is one beside which a parameter, or
// all parameters together, are farther off than machines of one make differ: something else may hide in them, by the odds of that against a machine that
// has such parameters, p_h / (p_h + chance), 0.4 to 0.9 (0.4 beside a stochastic effect, whose draws take the parameters along). The latter holds of nothing missing as
// well, unless the residual of the nominal machine is no more than noise (`is_nominal_enough`). What is taken from an effect goes to nothing missing
// where the residual of parameters alone is noise (`is_nothing_left`). Of the first of the causes it is told in `remarks`.
void doubt_what_no_machine_has(const common::EffectCatalogue& catalogue, const Nuisances& nuisances, bool is_nominal_enough, bool is_nothing_left, Ranking& ranking,
                               std::vector<std::string>& remarks);

// Parameters alone leave no more than noise, but such as machines of one make do not have: another machine than the nominal one explains the records as well as an effect that leaves
// the parameters nearer. No such effect is sure, but for those that say of the machine what a parameter stands for. Of the first of the causes it is told in `remarks`.
void doubt_what_parameters_do_as_well(const common::EffectCatalogue& catalogue, const std::vector<FarParameter>& far, Ranking& ranking, std::vector<std::string>& remarks);

// A draw of a stochastic effect takes whatever has its power. It may stand for the law of the effect beside it, where the residual of that effect
// alone is no larger a share of the gap than that of a law other than the catalogue's (the share of a cause that nobody knows, evidence.h). Then the
// cause is not sure, and the first of them is told in `remarks`.
void doubt_draws_beside_a_law(const common::EffectCatalogue& catalogue, const EvidenceSettings& evidence, Ranking& ranking, std::vector<std::string>& remarks);

// Whether an effect is a stochastic loss or delay of messages.
bool is_chance_on_the_wire(const common::EffectCatalogue& catalogue, const std::string& name);

// Commands that came between a record's rows, of a controller that is faster than the recorder, do what stochastic loss or delay of commands does. `may_hide_commands`: the records do not
// show the controller's cycle, and nobody gave it. Then none of these effects is sure, and the first of them is told in `remarks`.
void doubt_chance_on_the_wire(const common::EffectCatalogue& catalogue, bool may_hide_commands, Ranking& ranking, std::vector<std::string>& remarks);

// Of records that are taken to have commands between their rows, about a smooth course through them (hidden_commands.h), rows that were all of the commands and held until the next look late by half
// a row. So no steady effect that acts late by less than a row, `row` [s], is sure; the first of them is told in `remarks`.
void doubt_what_held_rows_do(const common::EffectCatalogue& catalogue, double row, Ranking& ranking, std::vector<std::string>& remarks);

// What only one accelerometer has seen, below `slow` [Hz], more slowly than anything of the machine, an offset of it that wanders does as well: no cause of which `share_of` that is most of what
// it explains is sure, and the first of them is told in `remarks`.
void doubt_what_an_offset_does(const std::function<ChannelShare(const Cause&)>& share_of, double slow, Ranking& ranking, std::vector<std::string>& remarks);

// Accelerometers that read by other gains than the machine's file has, in the place of a cause or of all of it but for one effect.
struct GainsInstead {
  double chance = 0.0;  // that they explain the records, against the cause (accelerometer_gains.h)
  std::string beside;   // the effect of the cause that is left; "" where none is
  std::string gains;    // in words
};

// A cause loses the chance that gains explain the records in its place; where an effect is left beside them, to the causes that have it. Of the first of the causes it is told in `remarks`.
void doubt_what_gains_do(const std::function<GainsInstead(const Cause&)>& instead_of, Ranking& ranking, std::vector<std::string>& remarks);

// No cause explains it: then it may still be a known effect with a law of its own. What its law is not is no noise, so the causes share by their evidence
// with that much less weight. None comes to lead by that which has not predicted anything.
void share_with_other_laws(Ranking& ranking);

// Of a controller whose answers could not be compared nobody knows whether it is as its settings say: that nothing is missing is then no more
// certain than effects of the controller are rare, among `all` effects alone or as one of two.
void leave_room_for_the_controller(std::size_t of_the_controller, std::size_t all, const EvidenceSettings& evidence, Ranking& ranking);

// Where nothing missing leads, it is no more certain than these records would show what is: an effect may act and be too small for them. It goes on leading. Gives the probability of that.
double leave_room_for_the_hidden(const Hidden& hidden, Ranking& ranking);

// What the evidence cannot know of the lead: it weighs hypotheses as they are fitted, and each is less sure than its best fit says.
void calibrate_lead(Ranking& ranking);

}  // namespace slewlab::diagnosis
