// The same for the tests.
#pragma once

#include "cmake/precompiled.h"

#include <gtest/gtest.h>
