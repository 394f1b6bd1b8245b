// Not code of ours: what a lcm-gen of tomorrow might write. scripts/cmake/GuardLcmTypes.cmake must refuse it.
#include <lcm/lcm_coretypes.h>
int tomorrow_t::_decodeNoHash(const void *buf, int offset, int maxlen) {
  data.resize(size);
}
