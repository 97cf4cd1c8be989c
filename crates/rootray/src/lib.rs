//! The boolean algebra of solids along one ray: root-rays and hit arrays.
