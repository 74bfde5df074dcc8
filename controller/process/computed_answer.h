#pragma once

// The controller behind the wire: per ENCODER one judgement of plausibility.h and one step of controller.h, as the
// function that AnswerLoop asks for.
// Settings and state live in the function; a copy of it runs on as the original would. `switched`, where it is given, is what is
// switched while the run goes on: it may grow between two answers, and outlives the function.

#include "controller/controller.h"
#include "controller/process/answer_loop.h"

namespace slewlab::controller {

// What the controller is stepped with: a reading as plausibility.h judges it, held where it is refused. The operator's wishes stay as they are.
void take_reading(const ControllerSettings& settings, const msgs::Encoder& encoder, PlausibilityState& plausibility, ControllerInput& input);

Compute computed_answer(const ControllerSettings& settings, const std::vector<PlaySwitch>* switched = nullptr);

}  // namespace slewlab::controller
