#include "runtime/main.h"

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bridge/bridge.h"
#include "runtime/self_check.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  std::optional<std::string> remote_url;
  std::vector<std::string> send, receive;
  std::optional<int> queue_mb;
  ChannelPolicies policies;
  VismapConfig config;
};

void AddOptions(CLI::App& app, Arguments* arguments) {
  app.add_option(
      "--remote-url", arguments->remote_url,
      "The other bus, for example tcpq://10.0.0.1:7700; the bus on this side is --lcm-url");
  app.add_option("--send", arguments->send,
                 "Channels to pass on from here to there, NAME,NAME; STATUS always goes both ways")
      ->delimiter(',');
  app.add_option("--receive", arguments->receive, "Channels to pass on from there to here")
      ->delimiter(',');
  app.add_option("--queue-mb", arguments->queue_mb,
                 "Megabytes that may wait in each direction while a bus is away; default 256")
      ->check(CLI::Range(1, 65536));
}

// The command line goes before the config.
Result<std::string> Configure(const std::string& text, const std::string& path,
                              Arguments* arguments) {
  const Result<std::string> taken = TakeConfig(text, path, &arguments->config);
  if (!taken) return taken;
  BridgeConfig& section = arguments->config.bridge;
  section.remote_url = arguments->remote_url.value_or(section.remote_url);
  if (!arguments->send.empty()) section.send = arguments->send;
  if (!arguments->receive.empty()) section.receive = arguments->receive;
  section.queue_mb = arguments->queue_mb.value_or(section.queue_mb);
  Result<ChannelPolicies> policies =
      ChannelPolicies::Make({section.lossless, section.latest, section.drop_newest});
  if (!policies) return tl::unexpected(policies.error());
  arguments->policies = std::move(*policies);
  const std::vector<std::string> problems = Validate(arguments->config);
  if (!problems.empty()) return Fail(problems.front());
  return PrintConfig(arguments->config);
}

Outcome Serve(const Arguments& arguments, ProcessContext& context) {
  const BridgeConfig& config = arguments.config.bridge;
  if (config.remote_url.empty()) return ExitWith(ExitCode::kUsage, "expected --remote-url");
  const Result<LcmUrl> local = ParseLcmUrl(context.options.lcm_url);
  if (!local) return ExitWith(ExitCode::kUsage, local.error().message);
  const Result<LcmUrl> remote = ParseLcmUrl(config.remote_url);
  if (!remote) return ExitWith(ExitCode::kUsage, remote.error().message);
  if (local->text == remote->text) {
    return ExitWith(ExitCode::kUsage, "both ends of the bridge are " + local->text);
  }
  WarnOfBus(*local);
  WarnOfBus(*remote);
  BridgeOptions options;
  options.local = *local;
  options.remote = *remote;
  if (context.options.name != "bridge") options.name = context.options.name;
  options.send = config.send;
  options.receive = config.receive;
  options.queue_bytes = static_cast<size_t>(config.queue_mb) * kMegabyte;
  options.policies = arguments.policies;
  const Result<std::unique_ptr<Bridge>> bridge = Bridge::Open(options);
  if (!bridge) return ExitWith(ExitCode::kFailed, bridge.error().message);
  context.service.Say("running: between " + local->text + " and " + remote->text);
  context.service.Ready();
  (*bridge)->Run(context.stop, [&] { context.service.Alive(); });
  context.service.Stopping();
  const auto total = [](const std::map<std::string, ForwardCounters>& channels) {
    int64_t forwarded = 0, dropped = 0;
    for (const auto& [name, counters] : channels) {
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
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "bridge";
  spec.summary = "Passes listed channels on between the bus of this computer and another one.";
  spec.joins_bus = false;
  spec.add_options = [&](CLI::App& app) { AddOptions(app, &arguments); };
  spec.configure = [&](const std::string& text, const std::string& path) {
    return Configure(text, path, &arguments);
  };
  spec.run = [&](ProcessContext& context) { return Serve(arguments, context); };
  return RunProcess(argc, argv, spec);
}
