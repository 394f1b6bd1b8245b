#pragma once

#include <string>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>

#include "base/result.h"
#include "runtime/bus.h"

namespace vismap {

/// Sends the request on the bus and waits for its answer; sends it again now and then, which a
/// server carries out only once. Fails when nobody answers within `timeout` [s], naming what should
/// run, and when the answer is a refusal.
Result<map_reply_t> SendRequest(Bus& bus, map_request_t request, double timeout);

}  // namespace vismap
