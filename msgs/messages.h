#pragma once

// The messages of the wire as C++ structs, made by lcm-gen from the .lcm files of this folder, and the
// channel each travels on. Fields and units: the .lcm files; who sends what when: docs/wire.md.

#include <slewlab_msgs/controller_state_t.hpp>
#include <slewlab_msgs/encoder_t.hpp>
#include <slewlab_msgs/motion_t.hpp>
#include <slewlab_msgs/operator_t.hpp>
#include <slewlab_msgs/plant_status_t.hpp>
#include <slewlab_msgs/sensors_t.hpp>
#include <slewlab_msgs/torque_t.hpp>
#include <slewlab_msgs/truth_t.hpp>

namespace slewlab::msgs {

using Encoder = slewlab_msgs::encoder_t;
using Torque = slewlab_msgs::torque_t;
using Operator = slewlab_msgs::operator_t;
using Sensors = slewlab_msgs::sensors_t;
using Truth = slewlab_msgs::truth_t;
using ControllerState = slewlab_msgs::controller_state_t;
using PlantStatus = slewlab_msgs::plant_status_t;
using Motion = slewlab_msgs::motion_t;

inline constexpr const char* kEncoderChannel = "ENCODER";
inline constexpr const char* kTorqueChannel = "TORQUE";
inline constexpr const char* kOperatorChannel = "OPERATOR";
inline constexpr const char* kSensorsChannel = "SENSORS";
inline constexpr const char* kTruthChannel = "TRUTH";
inline constexpr const char* kControllerStateChannel = "CONTROLLER_STATE";
inline constexpr const char* kPlantStatusChannel = "PLANT_STATUS";
inline constexpr const char* kMotionChannel = "MOTION";

}  // namespace slewlab::msgs
