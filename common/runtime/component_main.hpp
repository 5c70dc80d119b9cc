#pragma once

namespace lapis::runtime {

/// Runs the process of a component from start to end (common/runtime/run_component.hpp). Each component instantiates it
/// in its own source file, so that main.cpp compiles quickly.
template <class Component>
int run_component(int argc, char** argv);

}  // namespace lapis::runtime
