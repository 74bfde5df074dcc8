// Maps of a PLC's variables: those of config/plc, and what is said of wrong ones.
#include "tools/plc/plc_map.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "common/input_error.h"
#include "tests/msgs/temporary_folder.h"

namespace slewlab::tools {
namespace {

const std::filesystem::path kMaps = SLEWLAB_SOURCE_DIR "/config/plc";

const PlcSignal& signal_of(const PlcMap& map, std::string_view name, bool to_plc, int group = 0) {
  for (const PlcSignal& signal : map.signals) {
    if (signal.name == name && signal.to_plc == to_plc && signal.group == group) return signal;
  }
  throw std::runtime_error("no signal " + std::string(name));
}

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// What is said of a map in which `from` is `to`, behind the file's name; empty where nothing is wrong.
std::string said_after(const std::string& name, const std::string& from, const std::string& to) {
  const TemporaryFolder folder;
  std::string text = text_of(kMaps / name);
  const std::size_t place = text.find(from);
  if (place == std::string::npos) throw std::runtime_error("no " + from + " in " + name);
  text.replace(place, from.size(), to);
  const std::filesystem::path file = folder.path() / "map.yaml";
  std::ofstream(file) << text;
  try {
    load_plc_map(file);
    return {};
  } catch (const common::InputError& error) {
    const std::string told = error.what();
    return told.substr(file.string().size());
  }
}

TEST(PlcMap, ReadsPlacesTypesAndScales) {
  const PlcMap map = load_plc_map(kMaps / "modbus.yaml");
  EXPECT_EQ(map.protocol, PlcProtocol::modbus);
  EXPECT_EQ(map.address, "127.0.0.1:15020");
  EXPECT_TRUE(map.high_word_first);
  EXPECT_FALSE(map.ticked);
  EXPECT_EQ(map.timeout, 0.05);
  EXPECT_EQ(map.on_link_loss, LinkLoss::brake);
  EXPECT_EQ(map.group_count, 2);
  const PlcSignal& speed = signal_of(map, "shaft_speed", true, 1);
  EXPECT_EQ(speed.area, ModbusArea::holding);
  EXPECT_EQ(speed.number, 1);
  EXPECT_EQ(speed.type, "int16");
  EXPECT_EQ(speed.scale, 0.005);
  EXPECT_EQ(signal_of(map, "speed_request", true).scale, 1e-4);  // 0.01 %
  EXPECT_EQ(signal_of(map, "shaft_position", true).scale, 1.0);  // a float without one holds SI
  const PlcSignal& stop = signal_of(map, "emergency_stop", true);
  EXPECT_EQ(stop.number, 7);
  EXPECT_EQ(stop.bit, 0);
  EXPECT_TRUE(stop.inverted);
  EXPECT_EQ(signal_of(map, "motor_torque", false, 1).area, ModbusArea::input);
}

TEST(PlcMap, ReadsEveryMapOfSlewlab) {
  int maps = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kMaps)) {
    EXPECT_EQ(load_plc_map(entry.path()).group_count, 2) << entry.path();
    ++maps;
  }
  EXPECT_EQ(maps, 6);
}

TEST(PlcMap, ExplainsAWrongPlace) {
  EXPECT_EQ(said_after("modbus.yaml", "at: holding 6,", "at: holdin 6,"),
            ":20:23: key 'to_plc.speed_request.at': found 'holdin 6', expected holding N, input N, coil N or discrete N, N from 0 to 65535; "
            "holding N.B or input N.B for a flag in bit B, 0 to 15");
  EXPECT_EQ(said_after("modbus.yaml", "at: holding 4,", "at: holding 3,"),
            ":19:12: key 'to_plc.shaft_position.1.at': found 'holding 3', where shaft_position of group 1 lies, expected a place of its own "
            "for every signal");
  EXPECT_EQ(said_after("modbus.yaml", "at: holding 8,", "at: input 8,"),
            ":23:23: key 'to_plc.alive_counter.at': found 'input 8', which a server lets nobody write, expected a holding register or a coil: "
            "this signal goes to the PLC");
  EXPECT_NE(said_after("modbus.yaml", "at: input 0,", "at: input 65536,").find("found 'input 65536'"), std::string::npos);
  EXPECT_NE(said_after("modbus.yaml", "at: holding 4,", "at: holding 65535,").find("expected registers up to 65535"), std::string::npos);
  EXPECT_NE(said_after("opcua.yaml", "ns=2;s=Slewing.Speed1", "Slewing.Speed1").find("expected a node's identifier, such as ns=2;s="), std::string::npos);
  EXPECT_NE(said_after("ads.yaml", "GVL_Slewing.Speed1", "GVL Slewing").find("expected the name of a symbol"), std::string::npos);
}

TEST(PlcMap, ExplainsAWrongTypeOrScale) {
  EXPECT_EQ(said_after("modbus.yaml", "alive_counter: {at: holding 8, type: uint16}", "alive_counter: {at: holding 8, type: uint15}"),
            ":23:40: key 'to_plc.alive_counter.type': found 'uint15', expected 'uint16' (or one of bool, int16, uint16, int32, uint32, int64, "
            "uint64, float32, float64)");
  EXPECT_NE(said_after("modbus.yaml", "type: uint16}", "type: float32}").find("expected a whole number's type"), std::string::npos);
  EXPECT_NE(said_after("modbus.yaml", "unit: rad/s", "unit: N m").find("the unit 'N m', which measures something else, expected one of rad/s"),
            std::string::npos);
  EXPECT_NE(said_after("modbus.yaml", R"(, scale: {value: 0.01, unit: "%", source: "chosen: 10000 is the lever's end"})", "")
                .find("key 'to_plc.speed_request.scale': found nothing: the key is missing, expected what one digit of the int16 stands for"),
            std::string::npos);
  EXPECT_NE(said_after("modbus.yaml", "value: 0.005,", "value: 0,").find("expected what one digit stands for, not 0"), std::string::npos);
}

TEST(PlcMap, ExplainsWhatIsMissingOrUnknown) {
  EXPECT_NE(said_after("modbus.yaml", "  enable: {at: input 2.0}\n", "").find("key 'from_plc.enable': found nothing: the key is missing"),
            std::string::npos);
  EXPECT_NE(said_after("modbus.yaml", "  mode: {", "  mod: {").find("key 'from_plc.mod'"), std::string::npos);
  EXPECT_NE(said_after("modbus.yaml", "    - {at: input 1, type: int16, scale: {value: 0.01, unit: N m, source: \"as group 1\"}}\n", "")
                .find("key 'from_plc.motor_torque': found 1 entries, expected 2"),
            std::string::npos);
  EXPECT_NE(said_after("modbus_ticked.yaml", "  answered_counter: {at: input 10, type: uint32}\n", "")
                .find("key 'ticked': found true, expected from_plc.answered_counter beside it"),
            std::string::npos);
  EXPECT_NE(said_after("modbus.yaml", "127.0.0.1:15020", "127.0.0.1").find("expected HOST:PORT"), std::string::npos);
  EXPECT_NE(said_after("ads.yaml", "127.0.0.1.1.2", "127.0.0.1").find("expected six numbers with dots between"), std::string::npos);
  EXPECT_NE(said_after("modbus.yaml", "value: 50, unit: ms", "value: 0, unit: ms").find("key 'timeout'"), std::string::npos);
}

TEST(PlcMap, OfAScaleWithAWrongUnitTheUnitAloneIsTold) {
  EXPECT_EQ(said_after("modbus.yaml", "{value: 0.005, unit: rad/s", "{value: 0.005, unit: mm"),
            ":15:64: key 'to_plc.shaft_speed.0.scale': found the unit 'mm', which measures something else, expected one of rad/s, mrad/s, deg/s, rpm, 1/min");
  EXPECT_NE(said_after("modbus.yaml", "{value: 0.005,", "{value: 0,").find("found 0, expected what one digit stands for, not 0"), std::string::npos);
}

TEST(PlcMap, APortThatThereIsNotIsTold) {
  for (const char* port : {"99999", "0"}) {
    EXPECT_NE(said_after("modbus.yaml", "127.0.0.1:15020", std::string("127.0.0.1:") + port).find("with a port from 1 to 65535"), std::string::npos) << port;
  }
}

// 32767 digits of 1e-5 rad/s are 0.33 rad/s: every speed of a motor would be clipped.
TEST(PlcMap, AScaleWithWhichEverythingIsClippedIsTold) {
  EXPECT_NE(said_after("modbus.yaml", "{value: 0.005,", "{value: 0.00001,").find("key 'to_plc.shaft_speed.0.scale': found a scale with which int16 holds no more than 0.32767 rad/s"),
            std::string::npos);
  EXPECT_NE(said_after("modbus.yaml", "{value: 0.01, unit: \"%\"", "{value: 0.001, unit: \"%\"").find("int16 holds no more than 0.32767, expected one with which 1"),
            std::string::npos);
}

}  // namespace
}  // namespace slewlab::tools
