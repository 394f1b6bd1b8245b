#pragma once

#include <string>

#include "viewer/http_rules.h"
#include "viewer/leaves.h"
#include "viewer/process_list.h"
#include "viewer/questions.h"
#include "viewer/slice.h"
#include "viewer/web_server.h"
#include "wire/map_follower.h"

namespace vismap {

/// Answers GET /api/...: from what the viewer has itself, or by asking the map server.
class Api {
 public:
  /// All must outlive it.
  Api(const Board* board, const MapFollower* space, ProcessList* processes, Questions* questions)
      : board_(board), space_(space), processes_(processes), questions_(questions) {}

  /// `reply` is called once, now or later.
  void Get(const HttpTarget& target, const WebHandler::Reply& reply);

 private:
  void GetObjects(const HttpTarget& target, const WebHandler::Reply& reply);
  void GetCell(const HttpTarget& target, const WebHandler::Reply& reply);
  void GetObjectFile(const std::string& name, const WebHandler::Reply& reply);
  void GetSlice(const HttpTarget& target, const WebHandler::Reply& reply);
  void GetLeaves(const HttpTarget& target, const WebHandler::Reply& reply);

  const Board* board_;
  const MapFollower* space_;
  ProcessList* processes_;
  Questions* questions_;
  SliceAnswers slices_;
  LeafAnswers leaves_;
  // The newest answer about all objects, since making it costs the map server a while.
  std::vector<uint8_t> objects_;
  std::string objects_map_id_;
  int64_t objects_revision_ = -1;
  double objects_until_ = 0;  // MonotonicSeconds
};

}  // namespace vismap
