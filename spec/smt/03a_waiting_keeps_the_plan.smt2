; THEOREM    03a: what the guard admitted stays admitted while the reaction time runs out.
; ASSUMED    A plan is good for what is left, rho, of the reaction time (rho = eps is the guard);
;            a time t <= rho passes, in which the robot is no faster than w.
; CONCLUDED  The plan is good for rho - t, with the way and the age grown. For rho = 0 it is the
;            safe state (02), and braking keeps that (01a).
; SOURCE     own, the induction between ticks.
; TWIN       every tick begins a new reaction time for the old command.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const rho Real)      ; what is left of the reaction time
(declare-const t Real)        ; time that passes
(declare-const x Real)        ; robot's own way meanwhile
; Formulas
(define-fun plan_need ((s Real) (age Real) (rho Real)) Real
  (+ (* kappa (+ s (* w rho) (/ (* w w) (* 2 b)))) (* V (+ age rho (/ w b)))))

; Assumptions
(assert (> b 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= w 0))
(assert (>= rho 0))
(assert (>= t 0))
(assert (>= x 0))
(assert (<= t rho))
(assert (<= x (* w t)))
(assert (<= (plan_need s age rho) d))

; Conclusion, negated
(assert (not (<= (plan_need (+ s x) (+ age t) (- rho t)) d)))
(check-sat)
