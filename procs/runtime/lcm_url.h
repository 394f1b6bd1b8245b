#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"

namespace vismap {

/// Where the bus is when nobody says otherwise: $LCM_DEFAULT_URL, else the local hub.
std::string DefaultLcmUrl();

/// IPv4 address and port, numeric.
struct TcpAddress {
  std::string host;  ///< dotted numbers
  uint16_t port = 0;
};

/// Reads "127.0.0.1:7700" or "127.0.0.1" (port 7700). Refuses host names: LCM would take them for
/// this computer.
Result<TcpAddress> ParseTcpAddress(const std::string& text);

/// An LCM URL, checked.
struct LcmUrl {
  std::string text;        ///< as LCM takes it, options that we need added
  std::string provider;    ///< "tcpq", "udpm", "memq", ...
  TcpAddress hub;          ///< of tcpq
  int receive_buffer = 0;  ///< of udpm: bytes asked for
};

/// Fails on an URL that LCM would misunderstand in silence. udpm gets a receive buffer of 4 MB
/// unless it names one: with the system's default LCM loses messages above 130 kB.
Result<LcmUrl> ParseLcmUrl(const std::string& url);

/// Succeeds when a hub that speaks LCM's tcpq protocol answers within `timeout` [s].
Result<void> ProbeHub(const TcpAddress& hub, double timeout);

/// Succeeds when a socket of this computer can have a receive buffer of `bytes`; else names the one
/// command that mends it.
Result<void> ProbeReceiveBuffer(int bytes);

}  // namespace vismap
