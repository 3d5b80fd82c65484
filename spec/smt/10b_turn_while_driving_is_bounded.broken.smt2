; BROKEN     Twin of 10b_turn_while_driving_is_bounded.smt2: the turn is bounded for the reaction
;            time only.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const te Real)       ; when the command to rest takes effect
(declare-const tb Real)       ; time spent braking
(declare-const omega Real)    ; bound of the turn rate
(declare-const k0 Real)       ; cosine when the thing was seen
(declare-const phi0 Real)     ; angle turned since then
(declare-const phi Real)      ; angle turned from now to t
(declare-const t Real)        ; an instant before rest
(declare-const k Real)        ; cosine at t
; Formulas
(define-fun time_to_rest ((w Real)) Real eps)                ; BROKEN: w/b is missing

; Assumptions
(assert (> b 0))
(assert (> eps 0))
(assert (>= w 0))
(assert (>= te 0))
(assert (>= tb 0))
(assert (>= omega 0))
(assert (>= phi0 0))
(assert (>= phi 0))
(assert (>= t 0))
(assert (<= te eps))
(assert (<= (* b tb) w))
(assert (<= t (+ te tb)))
(assert (<= phi (* omega t)))
(assert (<= k (+ k0 phi0 phi)))

; Conclusion, negated
(assert (not (<= k (+ k0 phi0 (* omega (time_to_rest w))))))
(check-sat)
