#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "common/input_error.h"
#include "msgs/configuration_hash.h"
#include "msgs/log_reader.h"
#include "tools/campaign/study.h"
#include "tools/python/core/bindings.h"

namespace nb = nanobind;

namespace slewlab::tools {
namespace {

nb::str text(std::string_view words) { return nb::str(words.data(), words.size()); }

nb::dict study_of(const std::filesystem::path& path, const Changes& changes) {
  const Study study = load_study_file(path, overrides_of(changes));
  nb::list scenarios, vary;
  for (const std::filesystem::path& each : study.scenarios) scenarios.append(nb::cast(each));
  for (const VariedKey& each : study.vary) {
    nb::dict varied;
    varied["key"] = each.key;
    varied["spread"] = text(name_of(each.spread));
    varied["values"] = nb::cast(each.values);
    varied["unit"] = each.unit;
    varied["whole"] = each.whole;
    vary.append(varied);
  }
  nb::dict told;
  told["scenarios"] = scenarios;
  told["limits"] = study.limits.empty() ? nb::object(nb::none()) : nb::cast(study.limits);
  told["draw"] = text(name_of(study.draw));
  told["runs"] = study.runs;
  told["seed"] = study.seed;
  told["vary"] = vary;
  return told;
}

}  // namespace

void bind_campaign(nb::module_& m) {
  m.def("load_study", &study_of, nb::arg("path"), nb::arg("changes"), "A study file as a dict; InputError with every problem of it.");
  m.def("log_digest", [](const std::filesystem::path& path) { return msgs::hash_text(msgs::log_digest(path)); }, nb::arg("path"),
        "Of every byte of a log, as summary.json of a run tells it.");
}

}  // namespace slewlab::tools
