#include "runtime/main.h"

#include <string>
#include <vector>

#include "bridge/bridge.h"
#include "runtime/self_check.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

void AddOptions(CommandLine& line, BridgeOptions* config) {
  line.Option("--remote-url", &config->remote_url,
              "The other bus, for example tcpq://10.0.0.1:7700; the bus on this side is --lcm-url");
  line.Option("--send", &config->send,
              "Channels to pass on from here to there, NAME,NAME; STATUS always goes both ways");
  line.Option("--receive", &config->receive, "Channels to pass on from there to here, NAME,NAME");
  line.Option("--queue-mb", &config->queue_mb,
              "Megabytes that may wait in each direction while a bus is away")
      .Range(1, 65536);
}

Outcome Serve(const BridgeOptions& options, ProcessContext& context) {
  if (options.remote_url.empty()) return ExitWith(ExitCode::kUsage, "expected --remote-url");
  const Result<LcmUrl> local = ParseLcmUrl(context.options.lcm_url);
  if (!local) return ExitWith(ExitCode::kUsage, local.error().message);
  const Result<LcmUrl> remote = ParseLcmUrl(options.remote_url);
  if (!remote) return ExitWith(ExitCode::kUsage, remote.error().message);
  if (local->text == remote->text) {
    return ExitWith(ExitCode::kUsage, "both ends of the bridge are " + local->text);
  }
  WarnOfBus(*local);
  WarnOfBus(*remote);
  const std::string name = context.options.name == "bridge" ? "" : context.options.name;
  const Result<std::unique_ptr<Bridge>> bridge = Bridge::Open({*local, *remote, name}, options);
  if (!bridge) return ExitWith(ExitCode::kFailed, bridge.error().message);
  context.service.Say("running: between " + local->text + " and " + remote->text);
  context.service.Ready();
  (*bridge)->Run(context.stop, [&] { context.service.Alive(); });
  context.service.Stopping();
  const auto total = [](const std::map<std::string, ForwardCounters>& channels) {
    int64_t forwarded = 0, dropped = 0;
    for (const auto& [channel, counters] : channels) {
      forwarded += counters.forwarded;
      dropped += counters.dropped;
    }
    return std::to_string(forwarded) + " (dropped " + std::to_string(dropped) + ")";
  };
  LogInfo("sent " + total((*bridge)->sent()) + " messages, received " +
          total((*bridge)->received()));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  VismapConfig config;
  ProcessSpec spec;
  spec.name = "bridge";
  spec.summary = "Passes listed channels on between the bus of this computer and another one.";
  spec.joins_bus = false;
  spec.add_options = [&](CommandLine& line) { AddOptions(line, &config.bridge); };
  UseConfig(&config, &spec, [&] { return CheckOptions(config.bridge); });
  spec.run = [&](ProcessContext& context) { return Serve(config.bridge, context); };
  return RunProcess(argc, argv, spec);
}
