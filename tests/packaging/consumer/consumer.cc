// A program of somebody else: prints which process spoke first on the bus that its argument names.
#include <iostream>
#include <lcm/lcm-cpp.hpp>
#include <vismap/process_status_t.hpp>

struct Listener {
  void OnStatus(const lcm::ReceiveBuffer*, const std::string&,
                const vismap::process_status_t* status) {
    std::cout << status->process << " " << status->version << "\n";
  }
};

int main(int, char** argv) {
  lcm::LCM bus(argv[1]);
  if (!bus.good()) return 1;
  Listener listener;
  bus.subscribe("STATUS", &Listener::OnStatus, &listener);
  return bus.handle();
}
