; THEOREM    14a: with S2's Table 2, stopping is always 5 s dearer than maneuvering.
; ASSUMED    p1 and p2 are any posterior: at least 0, and 1 together; losses are those of Table 2.
; CONCLUDED  B(stop) - B(maneuver) = 5: the observation does not matter, and the robot never stops.
; SOURCE     S2 Table 2 and E22; spec/decide.md decide.INV-9.
; TWIN       stopping before an obstacle costs nothing, as S2's text has it.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const p1 Real)       ; probability of an obstacle
(declare-const p2 Real)       ; probability of none
(declare-const stop1 Real)    ; loss of stopping before an obstacle
; Formulas
(define-fun maneuver () Real (+ (* 0 p1) (* 5 p2)))
(define-fun stop () Real (+ (* stop1 p1) (* 10 p2)))

; Assumptions
(assert (>= p1 0))
(assert (>= p2 0))
(assert (= (+ p1 p2) 1))
(assert (= stop1 5))

; Conclusion, negated
(assert (not (= (- stop maneuver) 5)))
(check-sat)
