/* Where a program in Structured Text has the signals of the loop: docs/structured_text.md. In bytes, eight of a number, so that they
 * do not overlap where a PLC counts bytes nor where it counts numbers. Adapters share it. */
#ifndef SLEWLAB_EXAMPLES_PLACES_H
#define SLEWLAB_EXAMPLES_PLACES_H

enum {
  /* %IL */
  SPEED_REQUEST = 0, SHAFT_SPEED = 8, SHAFT_POSITION = 72, READING_COUNT = 136, READING_TIME = 144, READING_GROUPS = 152,
  /* %QL */
  MOTOR_TORQUE = 0, RAMPED_SPEED = 64, AVERAGE_TORQUE = 72, OFFSET_TORQUE = 80, PROPORTIONAL = 88, INTEGRAL = 152, MODE = 216,
  /* %IX, %QX, and from one group's number to the next one's */
  FLAGS = 2000, NUMBER = 8
};

#endif
