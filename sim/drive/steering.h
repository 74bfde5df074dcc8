#pragma once

// A run that is steered while it runs: what an operator at a desk asks for, as lines of text, made into what happens at the
// beginning of controller periods. What happened in a period is said in the same words that a scenario's file has for it, so that
// the scenario made of it does the same to the bit.
//
//   operator REQUEST STOP ACKNOWLEDGE   where lever and buttons stand: -1 ... 1, 0 or 1, 0 or 1
//   fault begin NUMBER KEY: VALUE, ...  a fault from now on: the keys of a scenario's fault but from and until
//   fault end NUMBER                    until now
//   effect NAME on|off                  an effect of the machine's file
//   play_compensation on|off            of the controller
//   pause, resume, cycle, speed FACTOR  of a lockstep run: FACTOR simulated seconds per second, 0 as fast as it goes
//   patience SECONDS                    of wall clock: silence of more counts as a desk that stands still
//   silence                             the desk stands still: the lever springs back until it says more
//   end                                 the run is over, as if its duration had come
//   lost                                nobody is there any more: the lever springs back, and the run ends when the machine stands
//
// Within one period only the lever's last place counts; a button that was pressed or let go is seen in a period of its own.

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/drive/fault.h"
#include "sim/drive/operator_move.h"
#include "sim/integrate/machine_settings.h"
#include "sim/model/crane_parameters.h"

namespace slewlab::sim {

// A fault that begins or ends with a period.
struct FaultSwitch {
  std::optional<Fault> begins;  // its number is that of all faults before it, those of the scenario included
  std::size_t ends = 0;         // where none begins: the number of the fault
};

struct SteeredPeriod {
  std::optional<OperatorMove> move;  // where it changes
  std::vector<EffectSwitch> effects;
  std::optional<bool> play_compensation;  // where it is switched
  std::vector<FaultSwitch> faults;
  bool ends_run = false;
};

struct SteeringSettings {
  std::int64_t controller_period = 0;  // [ns]
  DriveParameters drive{};
  std::uint64_t seed = 0;              // of the scenario
  std::size_t scenario_faults = 0;     // how many there are in the scenario
  std::vector<std::string> effects{};  // that can be switched
  std::int64_t after_loss = 0;         // [ns] from the loss of the operator to the end of the run: after_loss_of()
};

// [ns] In which a machine comes to rest on its own: 30 of its characteristic times. Chosen: twice what a ramp takes that uses a fifteenth of
// the rated torque.
std::int64_t after_loss_of(const CraneParameters& machine);

class Steering {
 public:
  explicit Steering(const SteeringSettings& settings) : settings_(settings) {}

  // A line of those above; anything else is refused, in words.
  void take(const std::string& line);

  // Whether the period that comes has to wait until more is said.
  bool holds() const { return paused_ && cycles_ == 0 && !lost_ && !ended_; }
  double speed() const { return lost_ ? 0.0 : speed_; }
  // [s] of wall clock that the desk may say nothing; whoever reads its lines measures it and then says `silence`.
  std::optional<double> patience() const { return patience_; }

  // What happens with the period that begins at `time` [ns].
  SteeredPeriod begin_period(std::int64_t time);

  // What was refused and what began and ended since it was asked last, one line each:
  //   refused WHY     fault NUMBER from SECONDS     fault NUMBER until SECONDS     effect NAME on|off SECONDS
  //   play_compensation on|off SECONDS
  std::vector<std::string> take_news();

 private:
  void take_operator(const std::string& rest);
  void take_fault(const std::string& rest);
  void take_effect(const std::string& rest);
  void take_patience(const std::string& rest);
  void let_go();
  void take_play_compensation(const std::string& rest);
  void begin_fault(std::int64_t time, const std::string& name, const std::string& text, SteeredPeriod& period);
  void refuse(const std::string& why) { news_.push_back("refused " + why); }

  SteeringSettings settings_;
  OperatorMove stands_;             // as the controller was told last
  std::deque<OperatorMove> wishes_;
  struct FaultWish {
    bool begins;
    std::string name, text;
  };
  std::vector<FaultWish> fault_wishes_;
  std::vector<EffectSwitch> effect_wishes_;
  std::optional<bool> play_compensation_wish_;
  std::vector<std::pair<std::string, std::size_t>> faults_;  // those under way: name and number
  std::size_t fault_count_ = 0;                              // begun so far, without the scenario's
  std::vector<std::string> news_;
  bool paused_ = false;
  std::int64_t cycles_ = 0;  // that a pause still lets pass
  double speed_ = 1.0;
  std::optional<double> patience_;
  bool ended_ = false, lost_ = false;
  std::optional<std::int64_t> lost_at_;  // [ns]
};

}  // namespace slewlab::sim
