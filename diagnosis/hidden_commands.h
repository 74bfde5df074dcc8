// Commands between the rows of a record. A recorder that is slower than the controller writes down every n-th of its commands; those between two rows act as well,
// and nobody knows them. What is slow in them lies on the polynomial through the six rows about them; what is fast, which a controller makes of its readings' noise, is in the
// hidden ones as large as in the written ones, and independent of it:
//
//   u(k + j / n) = sum over i = -2 ... 3 of l_i(j / n) u(k + i) + e,   j = 1 ... n - 1,    variance of what is fast s^2 = mean square of the third difference d^3 u / 20,
//
// l_i Lagrange's polynomials, d^3 as in torque_noise.h. So over a row the torque is off by the mean of n - 1 fast parts, and by those of the rows that the polynomial goes through, as a white noise of the
// variance (1 - 1 / n) s^2: what that mean's spectrum begins with. How many there are is not known either, and with it by how much they act ahead: a nuisance (nuisance.h). Kinks of a ramp, and torques that are switched, stand in few rows, and are left out of s^2.
#pragma once

#include <optional>
#include <span>

#include "controller/controller.h"
#include "diagnosis/record.h"
#include "diagnosis/shadow.h"

namespace slewlab::diagnosis {

// Whether commands may have come between the rows of a record.
bool may_hide_commands(std::span<const Record> records, const std::optional<controller::ControllerSettings>& controller);

// In a row, where nobody knows how many. On average n of them act (1 - 1 / n) / 2 of a row ahead of the one that is written: between a quarter, of two, and a half. Two are as likely as
// many, so the ends cost next to nothing: the deviation is half the range.
inline constexpr int kSomeCommands = 4;
inline constexpr double kLeadDeviation = 0.125;  // [rows] of that: (1/2 - 1/4) / 2

// Whether a record's commands, as it is judged, could have others between them: not where it has more of them than grid points, or readings between them, or torques that were measured.
bool can_have_commands_between(const Record& record);

// The same record with so many commands in each row, on the polynomials through the rows, and what nobody knows of them in its noise. As it is where it can have none.
Record with_commands_between(Record record, int commands_per_row);

// What it adds to the torques of such a record if the commands act by `lead` [s] earlier than there: their mean slope over each row times that.
MoreTorques torques_ahead(const Record& record, double lead);

}  // namespace slewlab::diagnosis
