// LAMMPS-DCM - deformable cells for LAMMPS. GPL-2.0-only, see LICENSE.

// Requests: there while somebody keeps the handle, gone with the last keeper.

#include "dcm_request.h"

#include <gtest/gtest.h>

#include <vector>

using LAMMPS_NS::DCMRequest;
using LAMMPS_NS::DCMRequests;

namespace {

std::vector<int> wanted(const DCMRequests<int> &requests)
{
  std::vector<int> values;
  requests.each([&values](int value) {
    values.push_back(value);
  });
  return values;
}

}    // namespace

TEST(Request, NobodyHasAsked)
{
  const DCMRequests<> requests;
  EXPECT_FALSE(requests.any());
  int calls = 0;
  requests.each([&calls](char) {
    calls++;
  });
  EXPECT_EQ(calls, 0);
}

TEST(Request, GoesWithItsKeeper)
{
  DCMRequests<> requests;
  {
    const DCMRequest<> handle = requests.add();
    EXPECT_TRUE(requests.any());
  }
  EXPECT_FALSE(requests.any());
}

TEST(Request, HandleThatNobodyKeepsIsNone)
{
  DCMRequests<> requests;
  requests.add();
  EXPECT_FALSE(requests.any());
}

// a style asks anew in every run: one request, not one more

TEST(Request, NewHandleReplacesThatOfTheRunBefore)
{
  DCMRequests<int> requests;
  DCMRequest<int> handle = requests.add(10);
  handle = requests.add(20);
  EXPECT_EQ(wanted(requests), std::vector<int>{20});
  for (int run = 0; run < 1000; run++) handle = requests.add(run);
  EXPECT_EQ(wanted(requests), std::vector<int>{999});
  handle.reset();
  EXPECT_FALSE(requests.any());
}

TEST(Request, AllKeepersAreHeard)
{
  DCMRequests<int> requests;
  const DCMRequest<int> one = requests.add(3);
  DCMRequest<int> two = requests.add(5);
  const DCMRequest<int> three = requests.add(3);
  EXPECT_EQ(wanted(requests), (std::vector<int>{3, 5, 3}));
  two.reset();
  EXPECT_EQ(wanted(requests), (std::vector<int>{3, 3}));
  EXPECT_TRUE(requests.any());
}

TEST(Request, CopiedHandleKeepsItUp)
{
  DCMRequests<> requests;
  DCMRequest<> first = requests.add();
  DCMRequest<> second = first;
  first.reset();
  EXPECT_TRUE(requests.any());
  second.reset();
  EXPECT_FALSE(requests.any());
}

// the owner may go first

TEST(Request, HandleOutlivesTheOwner)
{
  DCMRequest<double> handle;
  {
    DCMRequests<double> requests;
    handle = requests.add(0.5);
  }
  EXPECT_EQ(*handle, 0.5);
}
