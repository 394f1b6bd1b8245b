// Not used by vismap: code that a future lcm-gen might generate. scripts/cmake/GuardLcmTypes.cmake must reject it.
#include <lcm/lcm_coretypes.h>
int tomorrow_t::_decodeNoHash(const void *buf, int offset, int maxlen) {
  data.resize(size);
}
