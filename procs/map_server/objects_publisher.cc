#include "map_server/objects_publisher.h"

#include <utility>

#include "base/class_names.h"
#include "wire/object_list.h"

namespace vismap {

void ObjectsPublisher::PublishChanges(const MapSession& session, const MeshTracker& mesh) {
  const auto places = [&](SegmentLabel label) { return mesh.places().BlocksOf(label); };
  Publish(session, tracker_.Summarize(session.map(), mesh.surfaces(), places,
                                      ObjectOptionsFor(session.metadata(), options_)));
}

std::vector<ObjectSummary> ObjectsPublisher::PublishAll(const MapSession& session) {
  MapProducts products = MakeProducts(session.map(), session.metadata(), options_);
  up_ = std::move(products.up);
  return Publish(session, std::move(products.objects));
}

std::vector<ObjectSummary> ObjectsPublisher::Publish(const MapSession& session,
                                                     std::vector<ObjectSummary> objects) {
  const SemanticMap& map = session.map();
  ObjectList list{map.last_utime, session.metadata().map_id, map.revision, std::move(objects)};
  last_ = Encode(list, ClassName);
  bus_->Publish(kObjectsChannel, last_);
  revision_ = map.revision;
  repeat_pacer_.Restart();
  objects_ = std::move(list.objects);
  return objects_;
}

void ObjectsPublisher::Repeat() {
  if (last_.map_id.empty() || !repeat_pacer_.due()) return;
  bus_->Publish(kObjectsChannel, last_);
  repeat_pacer_.Restart();
}

}  // namespace vismap
