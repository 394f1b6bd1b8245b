#include "runtime/main.h"

#include <poll.h>

#include <cstdio>
#include <memory>
#include <string>

#include "doctor/findings.h"
#include "doctor/report.h"
#include "runtime/clock.h"
#include "runtime/transport.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  double seconds = 5;
  bool json = false, watch = false;
};

void Listen(Transport* transport, double seconds, const StopSignal& stop, BusPicture* picture) {
  const Transport::Sink sink = [&](const std::string& channel, std::span<const uint8_t> data) {
    picture->AddMessage(channel, data, MonotonicSeconds(), WallUtime());
  };
  const double end = MonotonicSeconds() + seconds;
  while (!stop.requested() && transport->connected() && MonotonicSeconds() < end) {
    pollfd waiting[2] = {{stop.fd(), POLLIN, 0}, {transport->fd(), POLLIN, 0}};
    poll(waiting, 2, 100);
    while (MonotonicSeconds() < end && transport->Receive(sink)) {
    }
  }
}

Result<std::unique_ptr<Transport>> Join(const LcmUrl& url, const StopSignal& stop) {
  auto transport =
      url.provider == "tcpq" ? OpenTcpqTransport(url.hub, &stop) : OpenLcmTransport(url);
  if (transport) (*transport)->Subscribe(".*");
  return transport;
}

/// Observes the bus once and prints the report; returns whether the bus is healthy.
bool Examine(const LcmUrl& url, const Arguments& arguments, ProcessContext& context) {
  const StopSignal& stop = context.stop;
  Listening listening;
  listening.lcm_url = url.text;
  listening.checks = CheckBus(url, 2);
  BusPicture picture(context.options.channel_prefix);
  const double start = MonotonicSeconds();
  if (const auto transport = Join(url, stop)) {
    Listen(transport->get(), arguments.seconds, stop, &picture);
  } else if (url.provider != "tcpq") {
    listening.checks.push_back({"LCM", false, transport.error().message});
  }
  listening.now = MonotonicSeconds();
  listening.seconds = listening.now - start;
  const std::vector<Finding> findings = Diagnose(listening, picture);
  const std::string report = arguments.json ? JsonReport(listening, picture, findings)
                                            : TextReport(listening, picture, findings);
  std::fputs(report.c_str(), stdout);
  std::fflush(stdout);
  return findings.empty();
}

Outcome Run(const Arguments& arguments, ProcessContext& context) {
  const Result<LcmUrl> url = ParseLcmUrl(context.options.lcm_url);
  if (!url) return ExitWith(ExitCode::kUsage, url.error().message);
  bool healthy = Examine(*url, arguments, context);
  while (arguments.watch && !context.stop.WaitFor(0.5)) {
    std::fputs("\n", stdout);
    healthy = Examine(*url, arguments, context);
  }
  if (healthy) return {};
  return ExitWith(ExitCode::kFailed, "problems were found; see the report");
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  VismapConfig config;
  ProcessSpec spec;
  spec.name = "doctor";
  spec.summary =
      "Observes the bus and reports its processes and channels, problems, and how to solve them. "
      "Exit "
      "code 0: healthy, 1: problems found.";
  spec.joins_bus = false;
  spec.add_options = [&](CommandLine& line) {
    line.Option("--seconds", &arguments.seconds, "How long to observe the bus [s]")
        .Range(0.1, 3600);
    line.Flag("--json", &arguments.json, "Print the report as JSON");
    line.Flag("--watch", &arguments.watch, "Repeat until stopped");
  };
  UseConfig(&config, &spec);
  spec.run = [&](ProcessContext& context) { return Run(arguments, context); };
  return RunProcess(argc, argv, spec);
}
