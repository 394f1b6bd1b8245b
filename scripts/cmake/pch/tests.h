// Precompiled for tests/: what procs/ has, and GoogleTest.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "procs.h"
