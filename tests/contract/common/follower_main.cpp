#include "tests/contract/common/follower_component.hpp"

int main(int argc, char** argv) { return lapis::runtime::run_component<lapis::test::FollowerComponent>(argc, argv); }
