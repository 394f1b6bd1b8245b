#include "map_server/objects_publisher.h"

#include <utility>

#include "base/class_names.h"
#include "wire/object_list.h"

namespace vismap {

void ObjectsPublisher::PublishChanges(const MapSession& session, const MeshTracker& mesh) {
  const auto places = [&](SegmentLabel label) { return mesh.places().BlocksOf(label); };
  Publish(session.map(), session.metadata().map_id,
          tracker_.Summarize(session.map(), mesh.surfaces(), places,
                             ObjectOptionsFor(session.metadata(), options_)));
}

void ObjectsPublisher::PublishAll(const MapSession& session) {
  Publish(session.map(), session.metadata().map_id,
          MakeProducts(session.map(), session.metadata(), options_).objects);
}

void ObjectsPublisher::PublishLate(const MapSession& session, const MapSnapshot& copy,
                                   std::vector<ObjectSummary> objects) {
  const std::string& map_id = copy.metadata.map_id;
  if (session.metadata().map_id != map_id) return;
  if (last_.map_id == map_id && revision_ > copy.map.revision) return;
  Publish(copy.map, map_id, std::move(objects));
}

void ObjectsPublisher::Publish(const SemanticMap& map, const std::string& map_id,
                               std::vector<ObjectSummary> objects) {
  ObjectList list{map.last_utime, map_id, map.revision, std::move(objects)};
  last_ = Encode(list, ClassName);
  bus_->Publish(kObjectsChannel, last_);
  revision_ = map.revision;
  repeat_pacer_.Restart();
  objects_ = std::move(list.objects);
}

void ObjectsPublisher::Repeat() {
  if (last_.map_id.empty() || !repeat_pacer_.due()) return;
  bus_->Publish(kObjectsChannel, last_);
  repeat_pacer_.Restart();
}

}  // namespace vismap
