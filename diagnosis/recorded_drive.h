// What a drive like the nominal machine's makes of the commands in a record: limits of torque and rate, enable, brakes
// (sim/drive/drive_protection.h), as in the loop. The observer's motors get that, not the commands.
//
// A record does not tell whether a message that is missing in it was missing on the wire, so what the drive makes of
// silence and of a frozen alive counter is not simulated: a trip is what PLANT_STATUS says, from there until it says
// otherwise or a TORQUE acknowledges it, and takes the torque away and lets the brakes fall in. A record that begins with the run, its motors at rest,
// begins with a drive that delivers nothing; any other with one that delivers the first command.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "diagnosis/record.h"
#include "sim/drive/drive_protection.h"
#include "sim/integrate/machine_settings.h"

namespace slewlab::diagnosis {

class RecordedDrive {
 public:
  // The record must outlive this.
  RecordedDrive(const Record& record, const sim::DriveProtectionSettings& protection);

  // What motors and brakes do from the next command (commands() of record.h), beginning with the first, to the one after. Not beyond
  // the record's end.
  sim::DriveCommand next();

  // Goes on in another record of the same machine, on the same grid, that holds the point before the next one; it must outlive this.
  void go_on_in(const Record& record);

 private:
  bool begins_at_rest() const;
  bool look_at_messages(std::int64_t time);
  void command(std::int64_t time);
  double time_of(std::size_t point) const;  // [s]

  const Record* record_;
  sim::DriveProtectionSettings protection_;
  sim::DriveRun run_;
  std::int64_t step_;                // [ns] from one command to the next
  sim::DriveProtectionState state_;
  msgs::Torque message_{};
  std::size_t point_ = 0;            // of the commands, the next
  std::size_t messages_ = 0;         // TORQUE up to this point
  std::size_t statuses_ = 0;         // PLANT_STATUS up to this point
  bool tripped_ = false;             // as the newest PLANT_STATUS says
  std::int64_t last_command_ = 0;    // [ns]
};

// Whether a trip holds the drive: tripped, or braked by a trip and not acknowledged since.
bool says_tripped(const msgs::PlantStatus& status);

// Which commands of a record are one message of the controller: those of one reading of the encoders, or of several where the controller is slower than the recorder, so that its
// commands change that far apart alone.
struct MessageCycle {
  std::size_t commands = 1;
  std::size_t first = 0;  // command with which a message begins
  // Of the message, from 0 on where one begins with the record; what is before the first beginning is of -1.
  std::int64_t sequence(std::size_t command) const { return static_cast<std::int64_t>((command + commands - first) / commands) - 1; }
};
MessageCycle message_cycle(const Record& record);

struct DriveSeries {
  std::array<std::vector<double>, sim::kMaximumGroupCount> motor_torque, brake_torque;  // [Nm per motor] of the groups there are
  std::vector<bool> enable;
};
// All that a RecordedDrive says over a whole record, which depends on no machine: at each command and, where there are several per grid point, what holds from
// each point to the next.
struct DriveCourse : DriveSeries {
  std::size_t per_point = 1;
  MessageCycle messages;
  bool is_filtered = false;  // what holds is what the commands are in the judged band, as the encoders are (judged_grid.h); else their mean
  DriveSeries held;          // nothing where there is one command per point
};
DriveCourse drive_course(const Record& record, const sim::DriveProtectionSettings& protection);
// The share of the time to the next point of the grid in which the motors are enabled.
double enabled_share(const DriveCourse& course, std::size_t point);

}  // namespace slewlab::diagnosis
