#pragma once

#include <string>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>

#include "base/result.h"
#include "runtime/bus.h"

namespace vismap {

/// Sends a request and waits for the answer. It repeats the request every few seconds; the server
/// carries it out only once. Fails when there is no answer within `timeout` [s], and when the
/// server rejects the request.
Result<map_reply_t> SendRequest(Bus& bus, map_request_t request, double timeout);

}  // namespace vismap
