#include "requests/object_edits.h"

#include <charconv>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "base/printable.h"
#include "freespace/occupancy_codec.h"
#include "freespace/shortest_text.h"
#include "objects/label_places.h"

namespace vismap {
namespace {

constexpr size_t kMostTerm = 60;                // of a text that is repeated in an error
constexpr size_t kMostBytes = size_t{1} << 27;  // of an answer, decompressed
constexpr const char* kAllowed =
    "expected id=7, id=s12 or class=NAME, with ':unknown' or ':inflate=METRES' behind it if "
    "wanted, separated by ';'";

Error Refusal(std::string_view term, const std::string& reason) {
  return Error{"without: '" + PrintableText(std::string(term), kMostTerm) + "': " + reason};
}

Result<void> ReadAction(std::string_view action, ObjectEditTerm* term) {
  if (action == "unknown") {
    term->action = ObjectAction::kMakeUnknown;
    return {};
  }
  constexpr std::string_view kInflate = "inflate=";
  if (!action.starts_with(kInflate)) return Fail(kAllowed);
  const std::string_view number = action.substr(kInflate.size());
  const auto [end, error] =
      std::from_chars(number.data(), number.data() + number.size(), term->inflate_m);
  if (error != std::errc() || end != number.data() + number.size() ||
      !(std::isfinite(term->inflate_m) && term->inflate_m > 0)) {
    return Fail("inflate is not a number of metres above 0; " + std::string(kAllowed));
  }
  term->action = ObjectAction::kInflate;
  return {};
}

Result<ObjectEditTerm> ParseTerm(std::string_view text) {
  ObjectEditTerm term;
  const size_t colon = std::min(text.find(':'), text.size());
  const std::string_view condition = text.substr(0, colon);
  if (!condition.starts_with("id=") && !condition.starts_with("class="))
    return tl::unexpected(Refusal(text, kAllowed));
  const Result<ObjectQuery> query = ParseObjectQuery(std::string(condition));
  if (!query) return tl::unexpected(Refusal(text, query.error().message));
  term.query = *query;
  if (colon == text.size()) return term;
  if (const Result<void> read = ReadAction(text.substr(colon + 1), &term); !read)
    return tl::unexpected(Refusal(text, read.error().message));
  return term;
}

/// The objects that a term selects; at least one.
Result<std::vector<ObjectSummary>> SelectTerm(std::span<const ObjectSummary> objects,
                                              const ObjectEditTerm& term) {
  auto selected = SelectObjects(objects, term.query);
  if (!selected) return Fail("without: " + selected.error().message);
  std::erase_if(*selected, [](const ObjectSummary& object) { return object.removed(); });
  if (selected->empty()) {
    return Fail("without: the map has no object with " + ToText(term.query) +
                "; see vismap-map objects");
  }
  return selected;
}

}  // namespace

Result<std::vector<ObjectEditTerm>> ParseObjectEdits(const std::string& without) {
  std::vector<ObjectEditTerm> terms;
  for (std::string_view rest = without; !rest.empty();) {
    const std::string_view part = rest.substr(0, rest.find(';'));
    rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    Result<ObjectEditTerm> term = ParseTerm(part);
    if (!term) return tl::unexpected(term.error());
    terms.push_back(std::move(*term));
  }
  if (terms.empty()) return Fail(std::string("without: no object is named; ") + kAllowed);
  return terms;
}

Result<std::vector<ObjectEdit>> ReadEdits(const SemanticMap& map,
                                          std::span<const ObjectSummary> objects,
                                          const LabelBlocks& blocks, const std::string& without) {
  const auto terms = ParseObjectEdits(without);
  if (!terms) return tl::unexpected(terms.error());
  // Objects with the same action are one edit: nothing of one stays where it touches another.
  std::map<std::pair<ObjectAction, double>, ObjectEdit> edits;
  for (const ObjectEditTerm& term : *terms) {
    const auto selected = SelectTerm(objects, term);
    if (!selected) return tl::unexpected(selected.error());
    ObjectEdit& edit = edits[{term.action, term.inflate_m}];
    edit.action = term.action;
    edit.inflate_m = term.inflate_m;
    for (const ObjectSummary& object : *selected) {
      for (const SegmentLabel segment : object.segments) {
        const SegmentLabel label = map.labels.Canonical(segment);
        const std::span<const BlockIndex> places = blocks(label);
        edit.labels.push_back(label);
        edit.blocks.insert(edit.blocks.end(), places.begin(), places.end());
      }
    }
  }
  std::vector<ObjectEdit> list;
  for (auto& entry : edits) list.push_back(std::move(entry.second));
  return list;
}

Result<EditedSpace> EditSpace(const SemanticMap& map, std::span<const ObjectEdit> edits,
                              const OccupancyOptions& options) {
  auto space = EditObjects(map, edits, options);
  if (!space) return Fail("without: " + space.error().message);
  return space;
}

Result<EditedSpace> EditSpace(const SemanticMap& map, const MapMetadata& metadata,
                              const std::string& without, const OutputOptions& options) {
  if (const auto terms = ParseObjectEdits(without); !terms) return tl::unexpected(terms.error());
  LabelPlaces places;
  places.AddBlocks(map.voxels, map.voxels.SortedIndices());
  places.MergeAll(map.labels);
  const auto edits = ReadEdits(
      map, MakeProducts(map, metadata, options).objects,
      [&](SegmentLabel label) { return places.BlocksOf(label); }, without);
  if (!edits) return tl::unexpected(edits.error());
  return EditSpace(map, *edits, options.free_space);
}

Answer AnswerOccupancy(const EditedSpace& space) {
  Answer answer;
  answer.message = std::to_string(space.delta.blocks.size()) +
                   " blocks differ: " + std::to_string(space.freed) + " voxels became free, " +
                   std::to_string(space.made_unknown) + " unknown, " +
                   std::to_string(space.made_occupied) + " occupied";
  answer.encoding = "occupancy";
  answer.payload = EncodeOccupancyDelta(space.delta);
  return answer;
}

Result<OccupancyDelta> ReadOccupancy(std::span<const uint8_t> payload) {
  return DecodeOccupancyDelta(payload, kMostBytes);
}

}  // namespace vismap
