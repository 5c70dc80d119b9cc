#pragma once

namespace lapis::runtime {

/// The whole life of a process (common/runtime/run_component.hpp). Each component's source instantiates it for its
/// component, so that main.cpp costs the compiler nothing.
template <class Component>
int run_component(int argc, char** argv);

}  // namespace lapis::runtime
