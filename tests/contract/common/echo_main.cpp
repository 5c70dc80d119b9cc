#include "tests/contract/common/echo_component.hpp"

int main(int argc, char** argv) { return lapis::runtime::run_component<lapis::test::EchoComponent>(argc, argv); }
