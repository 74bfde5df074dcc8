#include "diagnosis/evaluation/case_result.h"

#include <limits>
#include <nlohmann/json.hpp>

namespace slewlab::diagnosis::withheld {

using nlohmann::json;

namespace {

// null where there is none.
json optional_number(const std::optional<double>& number) { return number ? json(*number) : json(nullptr); }

std::optional<double> number_from(const json& j) { return j.is_null() ? std::nullopt : std::optional<double>(j.get<double>()); }

json planned(const std::optional<Manoeuvre>& manoeuvre) {
  if (!manoeuvre) return nullptr;
  json requests = json::array();
  for (const Request& request : manoeuvre->requests) requests.push_back({{"time_ramps", request.time}, {"speed_request", request.speed_request}});
  return {{"duration_ramps", manoeuvre->duration}, {"requests", requests}};
}

std::optional<Manoeuvre> planned_from(const json& j) {
  if (j.is_null()) return {};
  Manoeuvre manoeuvre{{}, j.at("duration_ramps")};
  for (const json& request : j.at("requests")) manoeuvre.requests.push_back({request.at("time_ramps"), request.at("speed_request")});
  return manoeuvre;
}

}  // namespace

json to_json(const CaseResult& result) {
  json causes = json::array(), subsystems = json::array();
  for (const NamedCause& cause : result.causes) {
    json sizes = json::array();
    for (const NamedSize& size : cause.sizes) {
      sizes.push_back({{"effect", size.effect},
                       {"parameter", size.parameter},
                       {"value", size.value},
                       {"low", size.low},
                       {"high", size.high}});
    }
    causes.push_back({{"effects", cause.effects},
                      {"probability", cause.probability},
                      {"group", cause.group},
                      {"residual_power", cause.residual_power},
                      {"prior", cause.prior},
                      {"information", cause.information},
                      {"residual_ratio", cause.residual_ratio},
                      {"held_out_ratio", optional_number(cause.held_out_ratio)},
                      {"nominal_held_out_ratio", optional_number(cause.nominal_held_out_ratio)},
                      {"sizes", sizes}});
  }
  for (const auto& [name, probability] : result.subsystems) {
    subsystems.push_back({{"subsystem", name}, {"probability", probability}});
  }
  return {{"case", result.name},
          {"follows", result.follows},
          {"next_manoeuvre", planned(result.next)},
          {"drawn_manoeuvre", planned(result.drawn)},
          {"refusal", result.refusal},
          {"gap", result.gap},
          {"probability_unknown", result.probability_unknown},
          {"causes", causes},
          {"subsystems", subsystems},
          {"unseen_before", result.unseen_before},
          {"unseen_after", result.unseen_after},
          {"seconds", result.seconds},
          {"simulations", result.simulations}};
}

CaseResult result_from(const json& j) {
  CaseResult result;
  result.name = j.at("case");
  result.refusal = j.at("refusal");
  result.gap = j.at("gap");
  result.probability_unknown = j.at("probability_unknown");
  for (const json& c : j.at("causes")) {
    NamedCause cause{c.at("effects"), c.at("probability"), c.at("group"), {}, c.at("residual_power"), c.at("prior"), c.at("information"), c.at("residual_ratio"),
                     number_from(c.at("held_out_ratio")), number_from(c.at("nominal_held_out_ratio"))};
    // JSON has no infinity: a bound that is not given lies there.
    const auto bound = [](const json& value, double otherwise) {
      return value.is_null() ? otherwise : value.get<double>();
    };
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (const json& s : c.at("sizes")) {
      cause.sizes.push_back({s.at("effect"), s.at("parameter"), bound(s.at("value"), kInfinity),
                             bound(s.at("low"), -kInfinity), bound(s.at("high"), kInfinity)});
    }
    result.causes.push_back(std::move(cause));
  }
  for (const json& s : j.at("subsystems")) result.subsystems.emplace_back(s.at("subsystem"), s.at("probability"));
  result.follows = j.at("follows");
  result.next = planned_from(j.at("next_manoeuvre"));
  result.drawn = planned_from(j.at("drawn_manoeuvre"));
  result.unseen_before = j.at("unseen_before");
  result.unseen_after = j.at("unseen_after");
  result.seconds = j.at("seconds");
  result.simulations = j.at("simulations");
  return result;
}

CaseAnswer answer_from(const json& j) {
  CaseAnswer answer;
  answer.name = j.at("case");
  answer.kind = kind_named(j.at("kind"));
  answer.visibility = j.at("visibility");
  answer.most_visible = j.at("most_visible");
  for (const json& e : j.at("effects")) {
    TrueEffect effect{e.at("law"), e.at("effect"), e.at("subsystem"), {}, e.at("visibility"), e.at("follows")};
    for (const json& s : e.at("sizes")) {
      effect.sizes.push_back({s.at("parameter"), s.at("value"), s.at("comparable")});
    }
    answer.effects.push_back(std::move(effect));
  }
  return answer;
}

}  // namespace slewlab::diagnosis::withheld
