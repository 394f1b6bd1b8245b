#include "runtime/main.h"

#include <string>
#include <vector>

#include "base/format.h"
#include "bridge/bridge.h"
#include "runtime/self_check.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

void AddOptions(CommandLine& line, BridgeOptions* config) {
  line.Option("--remote-url", &config->remote_url,
              "URL of the remote bus, for example tcpq://10.0.0.1:7700; the local bus is that of "
              "--lcm-url");
  line.Option("--send", &config->send,
              "Channels to forward to the remote bus: NAME,NAME; STATUS is always forwarded in "
              "both directions");
  line.Option("--receive", &config->receive, "Channels to forward from the remote bus: NAME,NAME");
  line.Option("--queue-mb", &config->queue_mb,
              "Size of the queue of each direction, in MB, for messages to a bus that is slow or "
              "not connected")
      .Range(1, 65536);
}

Outcome Serve(const BridgeOptions& options, ProcessContext& context) {
  if (options.remote_url.empty())
    return ExitWith(ExitCode::kUsage, "--remote-url is missing: the URL of the other bus");
  const Result<LcmUrl> local = ParseLcmUrl(context.options.lcm_url);
  if (!local) return ExitWith(ExitCode::kUsage, local.error().message);
  const Result<LcmUrl> remote = ParseLcmUrl(options.remote_url);
  if (!remote) return ExitWith(ExitCode::kUsage, remote.error().message);
  if (local->text == remote->text) {
    return ExitWith(ExitCode::kUsage,
                    "--lcm-url and --remote-url are the same bus, " + local->text);
  }
  WarnAboutBus(*local);
  WarnAboutBus(*remote);
  const std::string name = context.options.name == "bridge" ? "" : context.options.name;
  const Result<std::unique_ptr<Bridge>> bridge =
      Bridge::Open({*local, *remote, name, context.options.channel_prefix}, options);
  if (!bridge) return ExitWith(ExitCode::kFailed, bridge.error().message);
  context.service.SetStatus("running: between " + local->text + " and " + remote->text);
  context.service.SetReady();
  (*bridge)->Run(context.stop, [&] { context.service.KeepAlive(); });
  context.service.SetStopping();
  const auto total = [](const std::map<std::string, ForwardCounters>& channels) {
    int64_t forwarded = 0, dropped = 0;
    for (const auto& [channel, counters] : channels) {
      forwarded += counters.forwarded;
      dropped += counters.dropped;
    }
    return FormatCount(forwarded, "message") + " (dropped " + FormatCount(dropped) + ")";
  };
  LogInfo("sent " + total((*bridge)->sent()) + ", received " + total((*bridge)->received()));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  VismapConfig config;
  ProcessSpec spec;
  spec.name = "bridge";
  spec.summary = "Forwards the given channels between the bus of this computer and another bus.";
  spec.joins_bus = false;
  spec.add_options = [&](CommandLine& line) { AddOptions(line, &config.bridge); };
  UseConfig(&config, &spec, [&] { return CheckOptions(config.bridge); });
  spec.run = [&](ProcessContext& context) { return Serve(config.bridge, context); };
  return RunProcess(argc, argv, spec);
}
