// Nothing: the precompiled header of the tests needs a source to belong to (LAPIS_QUICK_TEST_BUILD).
